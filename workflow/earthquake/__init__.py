"""What an earthquake does at the site: its magnitude and distance, and the acceleration that these let expect."""

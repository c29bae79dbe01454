"""What a practitioner would compare a slide with: sliding blocks under a record, regressions over observed cases."""

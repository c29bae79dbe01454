"""Published slopes: what others found, what this program finds, and whether that is right (`noshiro verify`)."""

"""Tables as people have them: recordings, observations and designs, read by one reader."""

"""Parameters that are not known exactly: how outputs vary with them, and which one matters."""

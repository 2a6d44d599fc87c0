"""The best values of some parameters: closed forms, a search of all designs, and scipy's."""

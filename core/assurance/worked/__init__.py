"""Cases whose numbers stand elsewhere: worked values, measured speeds, figures of the thesis."""

"""Jobs: kept in a ledger, cut into blocks, carried out on Dask, resumed after a kill."""

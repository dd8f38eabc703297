def table(options): return None

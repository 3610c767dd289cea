"""Studies on simulated patients, one word each: ``python Testing/study methods --output DIR``. `make study` runs them."""

"""Looking at results: metrics against true bone, figures and reports. The only place that imports matplotlib."""

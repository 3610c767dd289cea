"""Looking at results: metrics against true bone, figures, reports and the study. The only place that imports matplotlib."""

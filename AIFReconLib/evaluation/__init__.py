"""Looking at results: figures, and later metrics and reports. The only place that imports matplotlib and vtk."""

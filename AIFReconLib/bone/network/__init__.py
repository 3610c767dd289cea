"""Networks that tell bone in a frame: the file, the process in which it is run, and the estimator."""

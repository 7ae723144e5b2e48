"""Error against run time: problems with a known answer, one setting turned at a time."""

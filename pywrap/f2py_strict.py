"""Run f2py and refuse what it only warns of: a kind it does not know becomes a wrong C type.

Usage: python f2py_strict.py OUTPUT_FOLDER FACE.f90 ...
"""

import subprocess
import sys

folder, *faces = sys.argv[1:]
command = [sys.executable, "-m", "numpy.f2py", *faces]
command += ["-m", "_core", "--lower", "--build-dir", folder]
done = subprocess.run(command, capture_output=True, text=True)
said = done.stdout + done.stderr
if done.returncode or "getctype" in said:
    sys.exit(said + "\nf2py: use c_double and c_int in the face")

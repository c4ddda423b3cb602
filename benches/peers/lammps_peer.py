"""LAMMPS with two of its Hertz styles, `gran/hertz/history` and `granular` with `hertz`, both without damping and friction.

All spheres get one radius, so that one coefficient makes the scene's stiffness; each has its own mass. Velocity Verlet is the
method of LAMMPS. Scenes with a stiffness of its own in some contact cannot be told to these styles.
"""

import math

import numpy as np
from lammps import lammps

from peer import serve

#: One engine a scene and style: starting one takes longer than a run. Keyed by (method, id of the problem).
ENGINES = {}
RADIUS = 1000.0


def engine(method, problem):
    key = method, id(problem)
    if key in ENGINES:
        return ENGINES[key]
    stiffness = problem.stiffness[1:]
    if np.ptp(stiffness) > 1e-9 * stiffness.max():
        raise ValueError("each contact has its own stiffness: not a scene for these styles")
    n = problem.n
    # Places in static equilibrium; the wall is at 0, the chain comes from below and points to -z.
    z = np.zeros(n)
    z[-1] = -(RADIUS - problem.overlap[n])
    for i in range(n - 2, -1, -1):
        z[i] = z[i + 1] - (2.0 * RADIUS - problem.overlap[i + 1])
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    far = -z[0] + 4 * RADIUS
    # F = K overlap^1.5 sqrt(Reff): Reff is half the radius between spheres, the whole one at the wall.
    pair, wall = stiffness[0] / math.sqrt(RADIUS / 2), stiffness[-1] / math.sqrt(RADIUS)
    pair, wall = float(pair), float(wall)
    smooth = "tangential linear_nohistory 0.0 0.0 damping velocity"
    if method == "hertz/history":
        style = f"pair_style gran/hertz/history {pair} 1.0 0.0 0.0 0.0 0\npair_coeff * *"
    else:
        style = f"pair_style granular\npair_coeff * * hertz {pair} 0.0 {smooth}"
    # The wall of the older style makes numbers that are none of a contact without friction.
    walls = f"fix wall all wall/gran granular hertz {wall} 0.0 {smooth} zplane NULL 0.0"
    # Weight is the striker's acceleration; what else pulls, pulls on particle 1.
    weight = float(problem.load[0])
    pull = float((problem.load[1] - weight) / problem.inverse_mass[1])
    create = "\n".join(f"create_atoms 1 single 0 0 {float(value)!r} units box" for value in z)
    lmp.commands_string(f"""
units lj
atom_style sphere
atom_modify map array sort 0 0
boundary f f f
newton off
comm_modify vel yes
region box block {-2 * RADIUS} {2 * RADIUS} {-2 * RADIUS} {2 * RADIUS} {-far} {2 * RADIUS} units box
create_box 1 box
{create}
set type 1 diameter {2 * RADIUS}
neighbor {0.1 * RADIUS} bin
neigh_modify delay 10 every 10 check yes
{style}
fix move all nve
{walls}
fix weight all gravity {weight} vector 0 0 1
group first id 2
fix pull first addforce 0.0 0.0 {pull}
thermo 1000000000
""")
    order = np.argsort(lmp.numpy.extract_atom("id"))
    ENGINES[key] = lmp, order, z
    return ENGINES[key]


def reset(lmp, order, z, problem):
    x, v = lmp.numpy.extract_atom("x"), lmp.numpy.extract_atom("v")
    mass = lmp.numpy.extract_atom("rmass")
    x[:] = 0.0
    v[:] = 0.0
    x[order, 2] = z
    v[order, 2] = problem.velocity
    mass[order] = 1.0 / problem.inverse_mass


def solve(method, setting, problem):
    lmp, order, z = engine(method, problem)
    reset(lmp, order, z, problem)
    states = []
    for span in problem.spans():
        steps, h = problem.steps(span, setting)
        lmp.command(f"timestep {float(h)!r}")
        lmp.command(f"run {steps} post no")
        x, v = lmp.numpy.extract_atom("x"), lmp.numpy.extract_atom("v")
        states.append(np.concatenate([x[order, 2] - z, v[order, 2]]))
    return states


serve(solve)

"""Points of comparison without an experiment folder: some runs, each with front, profiles and scalars."""

import numpy as np

from fvcollapse.diagnosis.points import Block, Points, Run

TIMES = np.array([0.1, 0.2, 0.3, 0.5, 1.0])
SIGMAS = {"front": 0.01, "profiles": 0.002, "final_height": 0.002, "runout": 0.01}


def fake_points(runs=2, places=8, kinds=(("final_height", "value"),)):
    """Points of `runs` experiments named r0, r1, ...; `kinds`: scalars with their kind."""
    blocks, measured, sigma, scales, start = [], [], [], [], 0

    def add(name, observable, time, x, value, kind="value"):
        nonlocal start
        blocks.append(Block(name, observable, "m", time, x, kind, start, start + len(time)))
        start += len(time)
        measured.append(value)
        sigma.append(np.full(len(time), SIGMAS[observable]))

    for number in range(runs):
        name, none = f"r{number}", np.array([np.nan])
        front = np.linspace(0.0, 1.0, 12)
        add(name, "front", front, np.full(12, np.nan), 0.2 + 0.3 * np.tanh(4.0 * front))
        time, x = np.repeat(TIMES, places), np.tile(np.linspace(0.02, 0.5, places), len(TIMES))
        add(name, "profiles", time, x, 0.1 * np.exp(-4.0 * x) * np.exp(-time))
        for observable, kind in kinds:
            value = {"final_height": 0.08, "runout": 0.5}[observable]
            add(name, observable, none, none, np.array([value]), kind)
        scales.append(Run(name, 0.5, (0.05, 0.25, 0.4)))
    return Points((), tuple(blocks), np.concatenate(measured), np.concatenate(sigma), tuple(scales))

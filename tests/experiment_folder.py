"""A small experiment folder on disk, for tests that read one."""

SETTINGS = """
title = "a column of beads"
source = "made for a test"
[geometry]
slope_angle_deg = 16
height_0 = 0.14
length_0 = 0.2
channel_width = 0.1
[gate]
speed = 2.3
[material]
mu_1 = 0.44
mu_2 = 0.7
mu_bed = 0.5
[uncertainty]
thickness = 0.0015
mu_1 = 0.008
[front]
thickness = 0.0105
"""
FILES = {
    "front.csv": "t_s,x_front_m\n0.0,0.2\n0.1,0.24\n0.2,0.31\n",
    "profiles.csv": "t_s,x_m,h_m\n0.0,0.1,0.14\n0.0,0.15,0.139\n0.1,0.1,0.13\n0.1,0.3,-0.001\n",
    "volume.csv": "t_s,relative_volume_change,sigma\n0.0,0.0,0.002\n0.1,0.01,0.004\n",
    "interface.csv": "t_s,x_m,z_static_m\n0.1,0.1,0.08\n",
    "scalars.csv": "name,value,sigma,kind\nrunout,0.6,0.02,value\ntime_stop,1.4,,upper\n",
}


def write_experiment(folder, settings=SETTINGS, **changes):
    """The folder; `changes` replace (or, None, remove) CSV files by their stem."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.toml").write_text(settings, encoding="utf-8")
    for name, text in (FILES | {f"{stem}.csv": text for stem, text in changes.items()}).items():
        if text is not None:
            (folder / name).write_text(text, encoding="utf-8")
    return folder


def rows(table):
    """The lines of a table, every number to its last digit."""
    return "".join(",".join(repr(float(value)) for value in row) + "\n" for row in table)

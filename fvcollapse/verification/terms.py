"""Which term of the equations each verification problem proves, and the file that holds the term."""

TERMS = (
    (
        "µ(I), equations 3–7",
        "step/rheology.py",
        ("bagnold_22deg", "bagnold_24deg", "bagnold_28deg", "bagnold_gerris"),
    ),
    ("Drucker–Prager, equation 8", "step/rheology.py", ("incline_drucker_prager",)),
    ("yield stress", "step/rheology.py", ("film_bingham",)),
    (
        "yield in time, static–flowing interface",
        "step/coupled.py",
        ("stopping", "stopping_viscous"),
    ),
    ("regularisation", "step/rheology.py", ("creep",)),
    (
        "div(2ηD)",
        "step/viscous.py",
        ("film_newtonian", "poiseuille", "manufactured_velocity", "manufactured_surface_velocity"),
    ),
    ("ρ ∂u/∂t", "step/coupled.py", ("start_up", "couette_start_up")),
    (
        "ρ u·∇u",
        "step/momentum.py",
        (
            "taylor_green",
            "taylor_green_pressure",
            "manufactured_advection",
            "manufactured_advection_pressure",
            "manufactured_advection_courant",
            "cavity",
            "cavity_ghia",
        ),
    ),
    (
        "∇p, div u = 0",
        "step/coupled.py",
        ("manufactured_pressure", "manufactured_surface_pressure"),
    ),
    ("cut cells, hydrostatic balance", "step/geometry.py", ("tilted_box",)),
    (
        "bed and back wall, equations 12–14",
        "step/coulomb_walls.py",
        ("imposed_bed_stress", "bed_slip", "block"),
    ),
    (
        "lateral walls, equation 19",
        "step/lateral_friction.py",
        (
            "chute_drucker_prager_shallow",
            "chute_mu_I_shallow",
            "chute_drucker_prager_deep",
            "chute_mu_I_deep",
            "block_walls",
            "stopping_walls",
        ),
    ),
    (
        "free surface, equation 10",
        "step/level_set.py",
        ("disc", "zalesak", "vortex_2s", "vortex_8s"),
    ),
    ("a whole collapse", "simulation.py", ("viscous_slump", "dam_break", "dam_break_slope")),
    (
        "ill-posedness of the model",
        "step/ill_posedness.py",
        ("growth_ill_posed", "growth_well_posed"),
    ),
)
HEADING = (
    "| term | file | problem | grids | error L2 / L∞, finest grid | order (expected) or bound |\n"
    "|---|---|---|---|---|---|"
)


def markdown_table(rows):
    """The rows of `verify` as a table equation term → file → problem → measured error."""
    found = {row["name"]: row for row in rows}
    lines = [HEADING]
    for term, file, names in TERMS:
        lines += [markdown_line(term, file, found[name]) for name in names if name in found]
    return "\n".join(lines) + "\n"


def markdown_line(term, file, row):
    """One problem of the table."""
    grids = ", ".join(str(cells) for cells in row["grids"])
    judged = f"≤ {row['tolerance']:.1e}"
    if row["expected_order"] is not None:
        observed = row["observed_order"]
        judged = "none" if observed is None else f"{observed:.2f}"
        judged += f" ({row['expected_order']:g})"
    verdict = "" if row["passed"] else " **fails**"
    errors = f"{row['error_l2'][-1]:.1e} / {row['error_linf'][-1]:.1e}"
    return f"| {term} | `{file}` | {row['name']} | {grids} | {errors} | {judged}{verdict} |"

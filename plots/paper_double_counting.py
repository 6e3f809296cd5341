"""Are the lateral walls counted twice? Both parameter sets with and without the sink.

python -m plots.paper_double_counting
"""

from fvcollapse.draw.drawing import BLUE, GREEN, ORANGE
from plots.paper_style import WIDTH_NAME, main, panels, save

SETS = {
    "0.48, 0.73": ("muI", BLUE),
    "0.38, 0.64": ("mu38", ORANGE),
    "0.38, 0.64, µ_b = 0.38": ("mu38_bed38", GREEN),
}
SLOPES = (0, 10, 16, 19, 22)
MEASURED, ERROR, LIMIT = 0.475, 0.025, 1.6  # m from the back wall, w = 10 cm
CAPTION = """
Runout against slope for µ1, µ2 of the paper and of the inclined plane, with the sink (w = 10, 20 cm) and
without (w = ∞): at 5 mm thickness (solid) and 1 mm (dotted). Black: what is known at w = 10 cm, the measured
runout at 0 deg and the bound at 22 deg. At 22 deg and 0.38, w = ∞, nothing stops the flow: its value is that at
2 s.
"""


def draw(of):
    """One panel per width."""
    figure, axes = panels(1, 3, (12.0, 4.2), sharey=True)
    for panel, width in zip(axes[0], ("w10", "w20", "winf"), strict=True):
        for label, (name, colour) in SETS.items():
            for quantity, line in (("runout_5mm_m", "-"), ("runout_1mm_m", ":")):
                points = [of.value(f"{name}_a{slope}_{width}", quantity) for slope in SLOPES]
                values, errors, _ = zip(*points, strict=True)
                style = {"color": colour, "ls": line, "lw": 1.2, "capsize": 3}
                panel.errorbar(
                    SLOPES, values, errors, label=label if line == "-" else None, **style
                )
        if width != "w20":
            style = {"color": "black", "ls": "none", "capsize": 4}
            panel.errorbar([0], [MEASURED], [ERROR], marker="s", ms=4, label="measured", **style)
            panel.errorbar([22], [LIMIT], [0.2], uplims=True, marker="_", ms=12, **style)
        panel.set_title(f"{WIDTH_NAME[width]}", fontsize="medium")
        panel.set(xlabel="slope (°)", ylim=(0.2, 3.6))
    axes[0, 0].set_ylabel("runout from the back wall (m)")
    axes[0, 0].legend(frameon=False, fontsize="small")
    save(figure, "paper_double_counting", of, CAPTION, ("lateral_friction", "double_counting"))


if __name__ == "__main__":
    main(draw)

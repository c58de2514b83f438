# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: cylcontact
#     language: python
#     name: cylcontact
# ---

# %% [markdown]
# # Explore the maps
#
# Set the materials, a contact, a clearance, a load and a law to see the force–penetration curve,
# the difference from Johnson's law and from conformal contact, and the limits. Choosing a material
# fills in its numbers; change them for your own material. The pin, or the second roller, is of the
# same material unless you choose another. The yield stresses of the table are assumptions.
#
# The numbers come from `cylcontact.reports.explore`; this notebook only connects the controls.

# %%
import cylcontact as cc
from cylcontact.reports import explore
from cylcontact.reports.notebook import open_bench, require_extra

widgets = require_extra("ipywidgets")
display = require_extra("IPython.display")
bench = open_bench()
materials = {name: row.material for name, row in bench.materials().items()}

# %% [markdown]
# ## The controls

# %%
wide = {"style": {"description_width": "10em"}, "layout": widgets.Layout(width="28em")}
logarithmic = {"base": 10, "step": 0.01, "continuous_update": False, **wide}

material = widgets.Dropdown(
    options=list(materials), value="low-carbon steel", description="material", **wide
)
other = widgets.Dropdown(options=["same", *materials], description="pin or roller j", **wide)
modulus = widgets.FloatText(description="E (GPa)", **wide)
ratio = widgets.FloatText(description="ν (-)", **wide)
strength = widgets.FloatText(description="yield stress (MPa)", **wide)
contact = widgets.ToggleButtons(options=["internal", "external"], description="contact", **wide)
dR = widgets.FloatLogSlider(value=0.05, min=-3, max=3, description="ΔR (mm)", **logarithmic)
radius = widgets.FloatLogSlider(
    value=10.0, min=0, max=3, description="R_i of the hole (mm)", **logarithmic
)
load = widgets.FloatLogSlider(value=100.0, min=0, max=4, description="load (N/mm)", **logarithmic)
law = widgets.Dropdown(options=list(cc.laws.LAWS), value="enhanced", description="law", **wide)


def fill_in(_change=None):
    """Show the numbers of the material that was chosen."""
    chosen = materials[material.value]
    modulus.value, ratio.value = chosen.E / 1e3, chosen.nu
    strength.value = chosen.yield_stress or 0.0


material.observe(fill_in, names="value")
fill_in()

# %% [markdown]
# ## Results

# %%
picture, table = widgets.HTML(), widgets.HTML()


def update(_change=None):
    """Show the results for the controls, or the error message."""
    try:
        E = f"{modulus.value} GPa"
        own = cc.Material(material.value, E, ratio.value, strength.value or None)
        choice = explore.Choice(
            own,
            contact.value,
            dR.value,
            load.value,
            cc.laws.LAWS[law.value](),
            radius.value,
            material_j=materials.get(other.value),
        )
        drawn = explore.view(choice)
    except cc.InputError as error:
        picture.value, table.value = "", explore.as_message(error)
        return
    picture.value, table.value = drawn._repr_html_(), explore.as_table(drawn.headline)


controls = [material, modulus, ratio, strength, other, contact, dR, radius, load, law]
for control in controls:
    control.observe(update, names="value")
update()
display.display(widgets.HBox([widgets.VBox(controls), table]), picture)

# %% [markdown]
# ## The same as numbers
#
# Without controls, for a script or a table: any choice gives the same numbers.

# %%
bronze = cc.Material("bronze", E=110e3, nu=0.34, yield_stress=220)
explore.curve(explore.Choice(bronze, "internal", 0.02, 200.0, cc.laws.Explicit())).iloc[::32]

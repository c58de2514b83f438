"""The genetic search and the polish, on problems whose answer is known."""

import numpy as np
import pygad
import pytest

from cylcontact.datasets import Moments, concatenate
from cylcontact.fitting.genetic import CROSSOVERS, OPERATORS, WholePopulations, search
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.objectives import Problem, RmsLogPenetration, form_of
from cylcontact.fitting.polish import polish
from cylcontact.laws.law import Parameter

BOUNDS = {
    "internal": {
        "a": (0.1, 1.5),
        "b": (0.01, 0.5),
        "Y_log_scale": (1.0, 3.0),
        "Y_log_exponent": (-0.6, 0.0),
        "Y_slope": (-0.1, 0.1),
        "Y_offset": (0.8, 1.6),
        "n_exponent": (-0.1, 0.1),
    },
    "external": {"a": (0.1, 1.5), "b": (0.1, 3.0), "n": (1.0, 1.5)},
}
DR = {"internal": np.geomspace(0.05, 9.9, 31), "external": np.geomspace(5, 500, 15)}


def exact_problem(contact):
    """A problem whose data are the published law itself: its coefficients are the answer."""
    model = MODELS["enhanced", contact]
    published = np.array([list(model.published.values())])
    form = form_of(model, published, DR[contact])
    s = np.tile(np.linspace(-10, -4, 9), (DR[contact].size, 1))
    j = (s + form.c[0][:, None]) / form.n[0][:, None]
    data = concatenate(
        Moments.of_samples(dR, *row)
        for dR, row in zip(DR[contact], np.stack([s, j], axis=1), strict=True)
    )
    parameters = tuple(Parameter(name, *BOUNDS[contact][name]) for name in model.names)
    return Problem(model, parameters, RmsLogPenetration(data))


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_polish_recovers_the_coefficients_that_made_the_data(contact):
    problem = exact_problem(contact)
    truth = problem.point(problem.model.published)
    start = truth + 0.02 * (problem.high - problem.low) * np.cos(np.arange(truth.size))
    point, value = polish(problem, start)
    assert value < 1e-7
    assert point == pytest.approx(truth, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("crossover", CROSSOVERS)
def test_search_approaches_the_optimum_with_every_crossover(crossover):
    problem = exact_problem("external")
    actual = search(problem, population=40, generations=60, crossover=crossover, seed=3)
    middle = problem.value((problem.low + problem.high) / 2)
    assert actual.value < 0.05 * middle


def engine_of(kind, fitness, genes=5, elite=2):
    """PyGAD or ours, on a problem of individual fitness, for 30 generations."""
    return kind(
        num_generations=30,
        num_parents_mating=6,
        sol_per_pop=12,
        num_genes=genes,
        gene_space={"low": 0.0, "high": 1.0},
        fitness_func=fitness,
        fitness_batch_size=12,
        crossover_type="single_point",
        mutation_type=lambda offspring, engine: (
            offspring + 0.1 * engine.numpy_random_generator.normal(size=offspring.shape)
        ),
        keep_elitism=elite,
        random_seed=11,
        suppress_warnings=True,
    )


@pytest.mark.parametrize("name", [name for name in CROSSOVERS if name != "blend"])
@pytest.mark.parametrize("genes", [1, 2, 7])
def test_crossovers_make_the_offspring_that_pygad_makes_one_by_one(name, genes):
    theirs, ours = (engine_of(pygad.GA, lambda _, x, __: x.sum(axis=1), genes) for _ in range(2))
    parents = np.random.default_rng(genes).uniform(size=(6, genes))
    expected = getattr(theirs, f"{name}_crossover")(parents, (40, genes))
    assert np.array_equal(OPERATORS[name](parents, (40, genes), ours), expected)


@pytest.mark.parametrize("elite", [1, 2, 5])
def test_whole_populations_evolve_as_in_pygad(elite):
    """Rounded fitness has ties, which must be ranked as PyGAD ranks them."""

    def fitness(_, genes, __):
        return np.round(-((genes - 0.3) ** 2).sum(axis=1), 2)

    theirs, ours = (engine_of(kind, fitness, 5, elite) for kind in (pygad.GA, WholePopulations))
    for engine in (theirs, ours):
        engine.run()
    assert np.array_equal(ours.population, theirs.population)
    assert np.array_equal(ours.last_generation_fitness, theirs.last_generation_fitness)
    assert ours.best_solutions_fitness == theirs.best_solutions_fitness
    assert ours.num_fitness_evaluations == theirs.num_fitness_evaluations

"""FMUs of clearance joints in FMPy and in libcosim."""

from ctypes import c_double

import numpy as np

from cylcontact.export import export_joint


def export_fmu(joint, folder):
    """Write a joint's FMU; return its path."""
    ((name, content),) = export_joint(joint, "fmu").items()
    path = folder / name
    path.write_bytes(content)
    return path


class Fmu:
    """An FMU in FMPy after its initialisation with these inputs; several may come from one file."""

    def __init__(self, path, folder, kind="ModelExchange", inputs=()):
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Model, FMU2Slave

        description = read_model_description(path)
        of_kind = lambda *names: [  # noqa: E731
            int(v.valueReference) for v in description.modelVariables
            if v.causality in names and v.type == "Real"
        ]  # fmt: skip
        self.inputs, self.outputs = of_kind("input"), of_kind("output")
        self.rates, self.parameters = of_kind("local"), of_kind("parameter")
        self.fmu = {"ModelExchange": FMU2Model, "CoSimulation": FMU2Slave}[kind](
            guid=description.guid, unzipDirectory=extract(path, folder), instanceName="joint",
            modelIdentifier=description.modelExchange.modelIdentifier,
        )  # fmt: skip
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        if len(inputs):
            self.set(inputs)
        self.fmu.exitInitializationMode()

    def set(self, motion):
        self.fmu.setReal(self.inputs, list(map(float, motion)))

    @property
    def wrench(self):
        """The outputs, with the flag last."""
        return np.array([*self.fmu.getReal(self.outputs), *self.fmu.getInteger([0])])

    @property
    def impact_rate(self):
        return self.fmu.getReal(self.rates)

    @property
    def indicators(self):
        values = (c_double * len(self.rates))()
        self.fmu.getEventIndicators(values, len(self.rates))
        return list(values)

    def completed(self, motion):
        """Complete a step; return whether it asks for an event."""
        self.set(motion)
        return self.fmu.completedIntegratorStep()[0]

    def at_event(self, motion):
        self.set(motion)
        self.fmu.enterEventMode()
        self.fmu.newDiscreteStates()
        self.fmu.enterContinuousTimeMode()


class Cosim:
    """An FMU in libcosim, with steps of one size in seconds."""

    def __init__(self, path, size):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimManipulator import CosimManipulator
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        log_output_level(CosimLogLevel.WARNING)
        self.execution = CosimExecution.from_step_size(step_size=round(size * 1e9))  # ns
        self.slave = CosimLocalSlave(fmu_path=str(path), instance_name="joint")
        self.index = self.execution.add_local_slave(local_slave=self.slave)
        self.manipulator = CosimManipulator.create_override()
        self.execution.add_manipulator(manipulator=self.manipulator)
        self.observer = CosimObserver.create_last_value()
        self.execution.add_observer(observer=self.observer)

    def step(self, inputs, motion, outputs):
        """Return outputs after a step."""
        self.manipulator.slave_real_values(self.index, inputs, list(map(float, motion)))
        assert self.execution.step()
        return np.array(self.observer.last_real_values(self.index, outputs))

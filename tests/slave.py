"""An importer of FMUs of either version."""

import numpy as np
from exported_models import H


class Slave:
    """An instance of an FMU, set and read by names."""

    def __init__(self, path, folder, log=None, before=()):
        from fmpy import read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        own = read_model_description(path, validate=False)
        self.names = {one.name: one.valueReference for one in own.modelVariables}
        self.description = own
        three = own.fmiVersion == "3.0"
        self.fmu = (FMU3Slave if three else FMU2Slave)(
            guid=own.guid, unzipDirectory=str(folder), instanceName="a",
            modelIdentifier=own.coSimulation.modelIdentifier)
        self.get, self.set = ((self.fmu.getFloat64, self.fmu.setFloat64) if three else
                              (self.fmu.getReal, self.fmu.setReal))
        self.states = ((self.fmu.getFMUState, self.fmu.setFMUState, self.fmu.serializeFMUState,
                        self.fmu.deserializeFMUState) if three else
                       (self.fmu.getFMUstate, self.fmu.setFMUstate, self.fmu.serializeFMUstate,
                        self.fmu.deSerializeFMUstate))
        if three:
            self.fmu.instantiate(**({"logMessage": log} if log else {}))
        else:
            self.fmu.instantiate()
        self.begin(before)

    def begin(self, before=()):
        """Initialize it, after setting some parameters by name."""
        if hasattr(self.fmu, "setupExperiment"):
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        for name, value in before:
            self.set([self.names[name]], [value])
        self.fmu.exitInitializationMode()

    def put(self, **values):
        for name, value in values.items():
            self.set([self.names[name.replace("_", " ")]], [value])

    def read(self, *names):
        return self.get([self.names[name] for name in names])

    def steps(self, first, last, h=H):
        """Tip and pin force after every step, with a push that changes in each."""
        found = []
        for k in range(first, last):
            self.put(push=np.sin(0.1 * k))
            self.fmu.doStep(currentCommunicationPoint=k * h, communicationStepSize=h)
            found.append(self.read("bob.position.x", "bob.position.y", "pin.force.y"))
        return np.array(found)

    def derivatives(self, unknowns, knowns, seed):
        """Directional derivatives, by names."""
        return np.array(self.fmu.getDirectionalDerivative(
            [self.names[name] for name in unknowns], [self.names[name] for name in knowns], seed))

# script-version: 2.0
# Notes down the greatest depth that ParaView finds on the grid.
import os
from paraview.simple import TrivialProducer

grid = TrivialProducer(registrationName='grid')
particles = TrivialProducer(registrationName='particles')


def catalyst_execute(info):
    grid.UpdatePipeline(info.time)
    particles.UpdatePipeline(info.time)
    with open(os.environ['FRANA_CATALYST_NOTES'], 'a') as notes:
        notes.write('%.17g %.9g %d\n' % (info.time, grid.PointData['depth'].GetRange()[1],
                                         particles.GetDataInformation().GetNumberOfPoints()))

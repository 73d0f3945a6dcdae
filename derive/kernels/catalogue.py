"""Elements by the name of their kernel."""

from functools import partial

from sebody.derive.formulas import actuators, forces, joints, rigid

ELEMENTS = {
    "parallel_ground": lambda: joints.parallel(True),
    "parallel": lambda: joints.parallel(False),
    "perpendicular": joints.perpendicular,
    "coincident_ground": lambda: joints.coincident(True, False),
    "coincident": lambda: joints.coincident(False, False),
    "planar_coincident_ground": lambda: joints.coincident(True, True),
    "planar_coincident": lambda: joints.coincident(False, True),
    "on_plane": lambda: joints.off_plane(1, False),
    "on_line": lambda: joints.off_plane(2, False),
    "planar_on_line": lambda: joints.off_plane(1, True),
    "planar_aligned": joints.aligned,
    "distance": lambda: joints.distance(False),
    "planar_distance": lambda: joints.distance(True),
    "turn_drive": lambda: joints.turn_drive(False),
    "planar_turn_drive": lambda: joints.turn_drive(True),
    "slide_drive": lambda: joints.slide_drive(False),
    "planar_slide_drive": lambda: joints.slide_drive(True),
    "rigid_body": lambda: rigid.rigid_body(False),
    "planar_rigid_body": lambda: rigid.rigid_body(True),
    "point_mass": lambda: rigid.point_mass(False),
    "planar_point_mass": lambda: rigid.point_mass(True),
    "force": lambda: forces.force(False, False),
    "torque": lambda: forces.torque(False, False),
    "planar_force": lambda: forces.force(True, False),
    "planar_torque": lambda: forces.torque(True, False),
    "follower_force": lambda: forces.force(False, True),
    "follower_torque": lambda: forces.torque(False, True),
    "planar_follower_force": lambda: forces.force(True, True),
    "mode_force": forces.mode_force,
    "spring": lambda: forces.spring(False),
    "planar_spring": lambda: forces.spring(True),
    "torsion_spring": lambda: forces.torsion_spring(False),
    "planar_torsion_spring": lambda: forces.torsion_spring(True),
    "bushing": lambda: forces.bushing(False),
    "planar_bushing": lambda: forces.bushing(True),
    **{"planar_" * planar + f"{way}_{part.__name__}": partial(part, way, planar)
       for way in actuators.WAYS for part in (actuators.motor, actuators.rotor)
       for planar in (False, True)},
}

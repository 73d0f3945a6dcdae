"""Elements by the name of their kernel."""

from functools import partial

from sebody.derive.formulas import (
    actuators,
    contacts,
    couplings,
    forces,
    frictions,
    joints,
    rigid,
    ropes,
    stops,
    table_springs,
)

SMOOTH_ALONG_PATHS = {      # those of both kinds whose one unknown of motion is the way on a path
    "way_motor": lambda: actuators.motor("way", False),
    "way_rotor": lambda: actuators.rotor("way", False),
    "way_spring": forces.way_spring,
}
LAWS_ALONG_PATHS = {
    "friction_way": lambda: frictions.friction_way(False),
    "planar_friction_way": lambda: frictions.friction_way(True),
    "way_stop": stops.way_stop,
}
LAWS_OF_SLIP = {            # of ropes on sheaves: a motion without mass
    "friction_rope": lambda: ropes.friction_rope(False),
    "planar_friction_rope": lambda: ropes.friction_rope(True),
}
SMOOTH = {          # joints, bodies and forces whose column is written in the unknowns
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
    **{"planar_" * planar + f"couple_{first}_{second}": partial(
        couplings.couple, first, second, planar)
       for first, second in couplings.PAIRS for planar in (False, True)},
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
    **{"planar_" * planar + f"table_{make.__name__}": partial(make, planar)
       for make in (table_springs.spring, table_springs.torsion_spring, table_springs.bushing)
       for planar in (False, True)},
    "torsion_spring": lambda: forces.torsion_spring(False),
    "planar_torsion_spring": lambda: forces.torsion_spring(True),
    "bushing": lambda: forces.bushing(False),
    "bearing": lambda: forces.bearing(False),
    "planar_bearing": lambda: forces.bearing(True),
    "planar_bushing": lambda: forces.bushing(True),
    "rope": lambda: ropes.rope(False),
    "planar_rope": lambda: ropes.rope(True),
    "rope_grip": lambda: ropes.grip(False),
    "planar_rope_grip": lambda: ropes.grip(True),
    "rope_wheel": lambda: ropes.wheel(False),
    "planar_rope_wheel": lambda: ropes.wheel(True),
    **{"planar_" * planar + f"rope_{name}": partial(ropes.span, planar, sheaves)
       for sheaves, name in enumerate(ropes.SPANS) for planar in (False, True)},
    **{"planar_" * planar + f"{way}_{part.__name__}": partial(part, way, planar)
       for way in ("turn", "slide", "line") for part in (actuators.motor, actuators.rotor)
       for planar in (False, True)},
    **SMOOTH_ALONG_PATHS,
}
LAWS = {            # laws along measures, with numbers that are kept from step to step
    # friction in joints: f and m count the multipliers it reads, forces and moments
    "friction_turn": lambda: frictions.friction_turn(False, (0, 0)),
    "friction_turn_f3m2": lambda: frictions.friction_turn(False, (3, 2)),
    "friction_turn_f3m1": lambda: frictions.friction_turn(False, (3, 1)),
    "friction_slide": lambda: frictions.friction_slide(False, (0, 0)),
    "friction_slide_f2": lambda: frictions.friction_slide(False, (2, 0)),
    "friction_slide_f2m3": lambda: frictions.friction_slide(False, (2, 3)),
    "friction_cylindrical_f2m2": frictions.friction_cylindrical,
    "friction_spherical": lambda: frictions.friction_spherical((0, 0)),
    "friction_spherical_f3": lambda: frictions.friction_spherical((3, 0)),
    "planar_friction_turn": lambda: frictions.friction_turn(True, (0, 0)),
    "planar_friction_turn_f2": lambda: frictions.friction_turn(True, (2, 0)),
    "planar_friction_slide": lambda: frictions.friction_slide(True, (0, 0)),
    "planar_friction_slide_f1": lambda: frictions.friction_slide(True, (1, 0)),
    "planar_friction_slide_f1m1": lambda: frictions.friction_slide(True, (1, 1)),
    **LAWS_OF_SLIP,
    **LAWS_ALONG_PATHS,
    "turn_stop": lambda: stops.turn_stop(False),
    "slide_stop": lambda: stops.slide_stop(False),
    "distance_stop": lambda: stops.distance_stop(False),
    "gear_play": lambda: stops.gear_play(False),
    "planar_turn_stop": lambda: stops.turn_stop(True),
    "planar_slide_stop": lambda: stops.slide_stop(True),
    "planar_distance_stop": lambda: stops.distance_stop(True),
    "planar_gear_play": lambda: stops.gear_play(True),
    "sphere_on_plane": lambda: contacts.contact("plane", False, True),
    "sphere_on_sphere": lambda: contacts.contact("sphere", False, True),
    "sphere_on_cylinder": lambda: contacts.contact("cylinder", False, True),
    "point_on_plane": lambda: contacts.contact("plane", False, False),
    "point_on_sphere": lambda: contacts.contact("sphere", False, False),
    "point_on_cylinder": lambda: contacts.contact("cylinder", False, False),
    "planar_sphere_on_plane": lambda: contacts.contact("plane", True, True),
    "planar_sphere_on_sphere": lambda: contacts.contact("sphere", True, True),
    "planar_point_on_plane": lambda: contacts.contact("plane", True, False),
    "planar_point_on_sphere": lambda: contacts.contact("sphere", True, False),
}
ELEMENTS = SMOOTH | LAWS

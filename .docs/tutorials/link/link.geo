// A link with two eyes, in millimetres: 120 from hole to hole, 8 thick.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -4, 0, 0, 8, 14};
Cylinder(2) = {120, 0, -4, 0, 0, 8, 11};
Box(3) = {0, -5, -4, 120, 10, 8};
BooleanUnion(4) = {Volume{1}; Delete;}{Volume{2, 3}; Delete;};
Cylinder(5) = {0, 0, -4, 0, 0, 8, 8};
Cylinder(6) = {120, 0, -4, 0, 0, 8, 6};
BooleanDifference(7) = {Volume{4}; Delete;}{Volume{5, 6}; Delete;};
Physical Volume("link") = {7};      // elements of the volume alone are written
Mesh.MeshSizeMax = 5;
Mesh.ElementOrder = 2;

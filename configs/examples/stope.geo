// A stope in a reef, 20 m by 2 m, in a block of rock that is 80 m wide; lengths in m.
h_stope = 0.4;
h_far = 5;
half = 40;    // of the block
span = 10;    // half of that of the stope
width = 1;    // half of the thickness of the reef and of the stope

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, -width, 0};
Point(4) = {half, width, 0};
Point(5) = {half, half, 0};
Point(6) = {-half, half, 0};
Point(7) = {-half, width, 0};
Point(8) = {-half, -width, 0};
Point(11) = {-span, -width, 0};
Point(12) = {span, -width, 0};
Point(13) = {span, width, 0};
Point(14) = {-span, width, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 8};
Line(8) = {8, 1};
Line(11) = {8, 11};   // the lower contact of the reef, with the floor of the stope
Line(12) = {11, 12};
Line(13) = {12, 3};
Line(14) = {4, 13};   // the upper one, with its roof
Line(15) = {13, 14};
Line(16) = {14, 7};
Line(17) = {12, 13};  // faces of the stope
Line(18) = {14, 11};

Curve Loop(1) = {1, 2, -13, -12, -11, 8};
Curve Loop(2) = {4, 5, 6, -16, -15, -14};
Curve Loop(3) = {11, -18, 16, 7};
Curve Loop(4) = {13, 3, 14, -17};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Plane Surface(4) = {4};

// Both bodies share the curves between them and hence their nodes: the contacts are bonded.
Physical Surface("rock") = {1, 2};
Physical Surface("reef") = {3, 4};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2, 3, 4};
Physical Curve("top") = {5};
Physical Curve("left") = {6, 7, 8};
Physical Curve("stope") = {12, 15, 17, 18};

Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Field[1] = Distance;
Field[1].CurvesList = {12, 15, 17, 18};
Field[1].Sampling = 100;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = h_stope;
Field[2].SizeMax = h_far;
Field[2].DistMin = 5;
Field[2].DistMax = 40;
Background Field = 2;

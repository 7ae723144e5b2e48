// Square plate, 120 mm wide, with two holes on its diagonal; lengths in mm.
h_wall = 1.2;
h_far = 6;
half = 60;
radius = 8;
apart = 9;  // of each centre from the middle, in x and in y

Point(1) = {-half, -half, 0};
Point(2) = {half, -half, 0};
Point(3) = {half, half, 0};
Point(4) = {-half, half, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};

For i In {0:1}
  x = (2 * i - 1) * apart;
  y = (2 * i - 1) * apart;
  p = 10 * (i + 1);
  Point(p) = {x, y, 0};
  Point(p + 1) = {x + radius, y, 0};
  Point(p + 2) = {x, y + radius, 0};
  Point(p + 3) = {x - radius, y, 0};
  Point(p + 4) = {x, y - radius, 0};
  Circle(p + 1) = {p + 1, p, p + 2};
  Circle(p + 2) = {p + 2, p, p + 3};
  Circle(p + 3) = {p + 3, p, p + 4};
  Circle(p + 4) = {p + 4, p, p + 1};
  Curve Loop(p) = {p + 1, p + 2, p + 3, p + 4};
EndFor
Plane Surface(1) = {1, 10, 20};

Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("holes") = {11:14, 21:24};

// Elements grow from the walls outwards.
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Field[1] = Distance;
Field[1].CurvesList = {11:14, 21:24};
Field[1].Sampling = 50;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = h_wall;
Field[2].SizeMax = h_far;
Field[2].DistMin = 8;
Field[2].DistMax = 45;
Background Field = 2;

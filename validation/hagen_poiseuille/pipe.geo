// The pipe's wall: 96 flat strips inscribed in a circle of radius 0.5 m (area 0.07 % less than the circle's), its ends
// closed well outside the periodic box (x from 0 to 0.6 m).
// pipe.stl was made by Gmsh 4.8.4: gmsh -2 -format stl -bin -o pipe.stl pipe.geo
R = 0.5;
Point(1) = {-0.6, 0, 0, 1};
Point(2) = {-0.6, R, 0, 1};
Point(3) = {-0.6, 0, R, 1};
Point(4) = {-0.6, -R, 0, 1};
Point(5) = {-0.6, 0, -R, 1};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Transfinite Curve {1:4} = 25;
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Extrude {1.8, 0, 0} { Surface{1}; Layers{1}; }
Mesh.MeshSizeMax = 0.5;
Mesh.MeshSizeExtendFromBoundary = 0;
ReverseMesh Surface {1};              // its normal points out of the pipe, as the others' do

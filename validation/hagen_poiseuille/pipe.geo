// The pipe's wall, closed by half spheres well outside the periodic box (x from 0 to 0.6 m), so that it is smooth. Radius
// 0.5 m, drawn 0.155 % larger: flat triangles with their corners on it then enclose the circle's area.
// pipe.stl was made by Gmsh 4.8.4: gmsh -2 -format stl -bin -o pipe.stl pipe.geo
SetFactory("OpenCASCADE");
R = 0.5 * 1.00155;
Cylinder(1) = {-0.6, 0, 0, 1.8, 0, 0, R};
Sphere(2) = {-0.6, 0, 0, R};
Sphere(3) = {1.2, 0, 0, R};
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Mesh.MeshSizeMax = 0.08;
Mesh.MeshSizeMin = 0.08;

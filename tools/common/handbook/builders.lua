-- What the builders of a scene take and give. A line of `takes` is: name | unit | default | what it is; no default is "-", a
-- key that has to be given "required". tests/tools/handbook.lua holds the names against the sources, and runs the examples.
return {
  { name = "scene:particle", form = "scene:particle { position = { x, y, z }, ... }", gives = "its id, from 1",
    text = "One particle.",
    takes = [[
position | m | {0, 0, 0} | where it starts
velocity | m/s | {0, 0, 0} | its velocity at the start
mass: number | kg | 1 | 0 is allowed where a pin holds it
group | - | - | the name of its group
CHANNEL | its own | the channel's initial | a value of a channel that scene:channel has declared, by the channel's name]],
    example = "scene:particle { position = { 0, 0, 1 }, velocity = { 1, 0, 0 }, mass = 0.1 }" },
  { name = "scene:particles", form = "scene:particles { positions = { {x, y, z}, ... } }", gives = "a handle",
    text = "Many particles at once.",
    takes = [[
positions | m | required | a list of {x, y, z}
velocities | m/s | zeros | a list of as many
masses | kg | mass of each | a list of as many numbers
mass: number | kg | 1 | of each
group | - | - | the name of their group]],
    example = "scene:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 } }, mass = 0.5 }" },
  { name = "scene:grid", form = "scene:grid { nx =, ny =, width =, height =, ... }", gives = "a handle",
    text = "A rectangle of nx times ny particles with two triangles for each cell: cloth, nets, membranes.",
    takes = [[
nx | - | required | particles along u, from 1
ny | - | required | particles along v, from 1
width | m | 1 | its length along u
height | m | 1 | its length along v
origin | m | {0, 0, 0} | the corner of particle (1, 1)
u: number[] | - | {1, 0, 0} | direction of the first index
v: number[] | - | {0, 1, 0} | direction of the second
mass: number | kg | 1 | of all particles together; or density
density: number | kg/m^2 | - | mass per area: borders have half, corners a quarter
alternating | - | false | turns the diagonals of the triangles from cell to cell
material: string | - | - | a name of lib/material_numbers.lua, which gives the density
group | - | - | the name of their group]],
    example = "local cloth = scene:grid { nx = 9, ny = 9, density = 0.15, alternating = true }" },
  { name = "scene:membrane", form = "scene:membrane(grid or mesh, { stiffness =, nu =, damping = })", gives = "parameters of springs",
    text = "The spring constants by which the edges of a grid or mesh resist stretching like a sheet of that material, at any resolution.",
    takes = [[
stiffness: number | N/m | required | Young's modulus times thickness
nu: number | - | 1/3 | Poisson's ratio; a grid alone takes others
damping: number | N s/m | 0 | of the sheet, shared out as the stiffness is]],
    example = "local c = scene:grid { nx = 5, ny = 5 } scene:force('springs', scene:membrane(c, { stiffness = 100 }))" },
  { name = "scene:strand", form = "scene:strand { n =, from =, to = }",
    gives = "a handle with length, segment and, of a section, EA, EI, GJ",
    text = "A chain of particles: a string, a rope, a rod. A section (radius, E, density) gives mass and stiffness.",
    takes = [[
n | - | required | particles, from 2
from | m | {0, 0, 0} | where it starts
to: number[] | m | - | where it ends; or direction and length
direction: number[] | - | {0, 0, -1} | of a strand without to
length: number | m | 1 | of a strand without to
curve: number[][]|fun(s: number): number, number, number | m | - | a list of points, or a function of s from 0 to 1 that gives x, y, z
curl: table | m or 1/m | - | { radius =, pitch =, phase = } winds about the direction, { curvature =, torsion =, phase = } starts along it
mass: number | kg | 1 | in all; or radius and density
radius: number|number[] | m | - | of the section, or { a, b } of an ellipse
E: number | Pa | - | Young's modulus
nu: number | - | - | Poisson's ratio, for the twist (GJ)
density: number | kg/m^3 | - | with radius in the place of mass
clamped | - | false | the first segment lies in a wall and is pinned
pin | - | true | false: what is clamped is not pinned yet
group | - | - | the name of their group]],
    example = "local s = scene:strand { n = 9, length = 0.2, radius = 1e-3, E = 1e7, density = 1100, clamped = true }" },
  { name = "scene:hair", form = "scene:hair { on = { radius = 0.1 }, strands =, n =, length = }", gives = "a handle",
    text = "Strands with evenly spread roots along the normals of a sphere, a patch, a surface or a mesh.",
    takes = [[
on: table|hooke.Handle | m | required | { radius =, centre =, axis =, cap = }: a sphere, { origin =, u =, v = }: a patch; or a surface
strands: integer | - | required | how many
n | - | required | particles of each
length: number | m | 1 | of each
spread: number | rad | 0 | the largest angle to the normal, up to pi
vary_length: number | - | 0 | the largest part by which lengths differ, up to 0.99
vary_curl: number | - | 0 | the same of curls
curl: table | m or 1/m | - | as of a strand
seed: integer | - | the scene's | of what differs
mass: number | kg | 1 | of a strand; or radius and density
radius: number|number[] | m | - | of the section, or { a, b }
E: number | Pa | - | Young's modulus
nu: number | - | - | Poisson's ratio
density: number | kg/m^3 | - | with radius in the place of mass
clamped | - | true | the first segment lies in the skin and is pinned
pin | - | true | false: what is clamped is not pinned yet
group | - | - | the name of their group]],
    example = "scene:hair { on = { radius = 0.1, cap = 1 }, strands = 5, n = 4, length = 0.2 }" },
  { name = "scene:mesh", form = "scene:mesh { file = \"shirt.obj\" }", gives = "a handle",
    text = "Particles at the vertices of a mesh of triangles, and its triangles.",
    takes = [[
file | - | - | an OBJ file beside the script; or vertices and faces
vertices | m | - | a list of {x, y, z}
faces | - | - | a list of {a, b, c}, from 1
mass: number | kg | 1 | of all particles together; or density
density: number | kg/m^2 | - | mass per area
scale: number | - | 1 | by which the vertices are multiplied
origin | m | {0, 0, 0} | which is added then
material: string | - | - | a name of lib/material_numbers.lua
group | - | - | the name of their group]],
    example = "scene:mesh { vertices = { {0,0,0}, {1,0,0}, {0,1,0} }, faces = { {1,2,3} }, density = 1 }" },
  { name = "scene:surface", form = "scene:surface { file = \"rock.obj\" }", gives = "a table with vertices, faces and file",
    text = "Reads an OBJ file for plugins that take its numbers; the scene gets nothing of it.",
    takes = [[
file | - | required | an OBJ file beside the script
scale: number | - | 1 | by which the vertices are multiplied
origin | m | {0, 0, 0} | which is added then]] },
  { name = "scene:block", form = "scene:block { nx =, ny =, nz =, size = { a, b, c } }", gives = "a handle; with E its stiffness",
    text = "A box of particles filled with tetrahedra.",
    takes = [[
nx | - | required | particles along u, from 2
ny | - | required | particles along v
nz | - | required | particles along u x v
size: number[] | m | {1, 1, 1} | its three lengths
origin | m | {0, 0, 0} | its first corner
u: number[] | - | {1, 0, 0} | direction of the first index
v: number[] | - | {0, 1, 0} | direction of the second, at right angles to u
mass: number | kg | 1 | in all; or density
density: number | kg/m^3 | - | mass per volume
E: number | Pa | - | for handle.stiffness, of springs in the place of elements
group | - | - | the name of their group]],
    example = "scene:block { nx = 3, ny = 3, nz = 3, size = { 1, 1, 1 }, density = 1000 }" },
  { name = "scene:tetrahedra", form = "scene:tetrahedra { file = \"body.msh\" }", gives = "a handle; with E its stiffness",
    text = "A mesh of tetrahedra.",
    takes = [[
file | - | - | Gmsh's MSH 2.2 as text, beside the script; or vertices and tetrahedra
vertices | m | - | a list of {x, y, z}
tetrahedra | - | - | a list of {a, b, c, d}, from 1
mass: number | kg | 1 | in all; or density
density: number | kg/m^3 | - | mass per volume
scale: number | - | 1 | by which the vertices are multiplied
origin | m | {0, 0, 0} | which is added then
E: number | Pa | - | for handle.stiffness
group | - | - | the name of their group]],
    example = "scene:tetrahedra { vertices = { {0,0,0}, {1,0,0}, {0,1,0}, {0,0,1} }, tetrahedra = { {1,2,3,4} }, density = 1 }" },
  { name = "scene:body", form = "scene:body { shape = \"sphere\", radius = 0.3 }", gives = "a handle",
    text = "Something solid: the triangles of its surface, pinned as a whole, or free with a mass.",
    takes = [[
shape: "sphere"|"box"|"capsule"|"cylinder"|"plane"|"mesh" | - | required | sphere, box, capsule, cylinder, plane or mesh
radius: number | m | - | of a sphere, a capsule, a cylinder
length: number | m | - | of a capsule or a cylinder, along z
size: number|number[] | m | - | of a box, a number or {x, y, z}; of a plane a number
file | - | - | of a mesh, an OBJ file
scale: number | - | 1 | of a mesh
position | m | {0, 0, 0} | of its middle
orientation: number[] | rad | {0, 0, 0} | a rotation vector, at the start
path | m | - | a function of t that gives x, y, z
rotation | rad | - | a function of t that gives a rotation vector, about position
fastest: number | s | - | the least time in which path and rotation change
detail: number | - | 1e-3 | by how many radii round shapes are too thin at most
mass: number | kg | - | it is free then
density: number | kg/m^3 | - | the same
group | - | - | the name of its particles' group]],
    example = "scene:body { shape = 'sphere', radius = 0.3, position = { 0, 0, 1 }, detail = 0.05 }" },
  { name = "scene:implicit", form = "scene:implicit { f = function(x, y, z) return ... end, box =, size = }",
    gives = "a handle, or a surface",
    text = "A mesh of a formula, as a body, a solid of tetrahedra, or a surface for plugins; see scripts/README.md, Particles.",
    takes = [[
f: fun(x: number, y: number, z: number): number | - | - | a function of x, y, z; or blobs, or a list of shapes:
level: number | - | 0 | the value of f on the surface
inside: "above"|"below" | - | above | above or below: where f has what is inside
blobs: table[] | m | - | metaballs { x, y, z, radius =, weight = }
union | - | - | a list of shapes: all of them
intersection | - | - | a list of shapes: what they share
difference | - | - | a list of shapes: the first without the others
blend: number | - | 0 | edges between shapes are rounded off where values differ by less
size: number | m | required | of a cell
box: number[][] | m | the blobs' | {{x, y, z}, {x, y, z}}: where the surface is looked for
as: "body"|"solid"|"surface" | - | body | body, solid or surface
method: "tetrahedra"|"cubes" | - | tetrahedra | tetrahedra or cubes
close | - | false | closes what leaves the box along its faces
coarse: integer | - | 1, 2 or 4 | every so many corners are looked at first
position | m | {0, 0, 0} | of a body, as scene:body
orientation: number[] | rad | {0, 0, 0} | of a body
path: function | m | - | of a body
rotation: function | rad | - | of a body
fastest: number | s | - | of a body
mass: number | kg | - | of a body or a solid
density: number | kg/m^3 | - | of a body or a solid
E: number | Pa | - | of a solid
group | - | - | the name of its particles' group]],
    example = "scene:implicit { blobs = { { 0, 0, 1, radius = 0.3 } }, size = 0.1, as = 'surface' }" },
  { name = "scene:rigid", form = "scene:rigid { shape = \"box\", size = { 1, 2, 3 }, density = 700 }", gives = "a rigid body",
    text = "A rigid body, moments and all.",
    takes = [[
shape: "sphere"|"box"|"capsule"|"cylinder" | - | - | sphere, box, capsule or cylinder; or mesh, points, parts, or mass and inertia alone
radius: number | m | - | of a sphere, a capsule, a cylinder
length: number | m | - | of a capsule or a cylinder
size: number|number[] | m | - | of a box, or {x, y, z}
mesh: string | - | - | a closed OBJ file
scale: number | - | 1 | of the mesh
points | m | - | a list of {x, y, z}, with masses
masses: number[] | kg | - | of the points
parts | - | - | a list of these, each with its position and orientation
mass: number | kg | - | in all; or density
density: number | kg/m^3 | - | mass per volume
inertia: number[]|number[][] | kg m^2 | - | three moments, or the rows of a matrix, about the centre of mass
position | m | {0, 0, 0} | of the origin of its shape
orientation: number[]|number[][] | rad | {0, 0, 0} | a rotation vector, a quaternion {w, x, y, z} or a matrix
velocity | m/s | {0, 0, 0} | of its centre of mass
spin: number[] | rad/s | {0, 0, 0} | along the axes of the scene
group | - | - | the name of its particles' group]],
    example = "local box = scene:rigid { shape = 'box', size = { 1, 1, 1 }, density = 700 }" },
  { name = "scene:joint", form = "scene:joint { kind = \"hinge\", a = body, b = other, at = { x, y, z }, axis = { 0, 0, 1 } }",
    gives = "a joint",
    text = "Joins two bodies, or a body and a particle, or a body and the place where it is.",
    takes = [[
kind: "ball"|"hinge"|"slider"|"universal"|"fixed"|"distance" | - | required | ball, hinge, slider, universal, fixed or distance
a: hooke.Rigid | - | required | a rigid body
b: hooke.Rigid|integer | - | space | another one, or the id of a particle
at: number[] | m | - | where it is, at the start
axis: number[] | - | - | of a hinge, a slider, a universal joint
axis_b: number[] | - | - | of a universal joint, in b
to | m | - | of a distance: the point on b
contact | - | false | whether the surfaces of the two bodies meet each other]],
    example = "local w = scene:rigid { shape = 'sphere', radius = 1, mass = 1 } scene:joint { kind = 'ball', a = w, at = { 0, 0, 1 } }" },
}

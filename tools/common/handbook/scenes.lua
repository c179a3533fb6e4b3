-- The functions of `hooke`, of a scene beside its builders, and of a run; see builders.lua for the form of `takes`.
return {
  { name = "hooke.scene", form = "hooke.scene { duration = 2, fps = 60, ... }", gives = "a scene",
    text = "A scene, which the script returns. Units are SI. Frame k is at k/fps exactly.",
    takes = [[
duration | s | 1 | the end of the run, from 0
fps | 1/s | 60 | frames a second, above 0
dt | s | chosen | the longest step; of adaptive integrators the first
tol | - | the method's | relative tolerance of adaptive integrators, above 0
accuracy: number | m | - | of the positions (RMS), which the verdict then checks by other runs
accuracy_at: "frames"|"end" | - | frames | frames: at each of them; end: at the end
integrator: string|table | - | leapfrog | a name, or { name, parameter = value }, or auto; see `hooke plugins integrators`
solver: string|table | - | auto | a name or { name, parameter = value }; see `hooke plugins solvers`
seed: integer | - | 0 | of all random numbers
threads | - | chosen | 1 to 1024; results do not depend on it]],
    example = "" },
  { name = "hooke.gust", form = "hooke.gust { mean = { 5, 0, 0 }, amplitude = { 1, 1, 0 }, shortest = 0.5 }", gives = "a function of time",
    text = "A smooth irregular function of time, a number or a vector, for any parameter that may be one.",
    takes = [[
mean: number|number[] | the parameter's | required | about which it varies
amplitude: number|number[] | the parameter's | required | its RMS deviation
shortest: number | s | required | the shortest period, above 0
longest: number | s | 20 shortest | the longest period
seed: integer | - | 1 | of the phases]],
    example = "scene:particle {} scene:force('wind', { velocity = hooke.gust { mean = { 5, 0, 0 }, amplitude = { 1, 1, 0 }, "
      .. "shortest = 0.5 }, on = 'particles' })" },
  { name = "hooke.version", form = "hooke.version", gives = "a text", text = "The version of the contract of plugins." },
  { name = "param", form = "param(name, default, help, { min =, max = })", gives = "the value",
    text = "A parameter of the scene, which name=value on the command line sets; its type is that of the default.",
    takes = [[
min: number | its own | - | the least value
max: number | its own | - | the largest value]],
    example = "local N = param('N', 16, 'particles along a side', { min = 2, max = 200 })" },
  { name = "scene:force", form = "scene:force(name, { parameter = value, ... })",
    text = "Adds a force: see `hooke plugins forces`. Every force also takes label, only (ids) or group, from and to (s).",
    example = "scene:particle {} scene:force('gravity', { g = { 0, 0, -9.81 } })" },
  { name = "scene:constraint", form = "scene:constraint(name, { parameter = value, ... })",
    text = "Adds equations that hold at every step: see `hooke plugins constraints`.",
    example = "local s = scene:strand { n = 3 } scene:constraint('bars', { edges = s:edges() })" },
  { name = "scene:corrector", form = "scene:corrector(name, { parameter = value, ... })",
    text = "Adds what repairs positions and velocities after each step: see `hooke plugins correctors`.",
    example = "scene:particle {} scene:corrector('obstacle', { shape = 'plane', position = { 0, 0, -1 } })" },
  { name = "scene:source", form = "scene:source(name, { parameter = value, ... })",
    text = "Adds what lets particles be born and die: see `hooke plugins sources`.",
    example = "scene:source('emitter', { rate = 50 })" },
  { name = "scene:output", form = "scene:output(name, { parameter = value, ... })",
    text = "Adds what is written at frames: see `hooke plugins outputs`.",
    example = "scene:output('table')" },
  { name = "scene:integrator", form = "scene:integrator(name, { parameter = value, ... })",
    text = "The method by which time is stepped: see `hooke plugins integrators`, and the page \"Which integrator\".",
    example = "scene:integrator('rk4')" },
  { name = "scene:solver", form = "scene:solver(name, { parameter = value, ... })",
    text = "The solver of the linear systems of implicit methods: see `hooke plugins solvers`.",
    example = "scene:solver('supernodal')" },
  { name = "scene:service", form = "scene:service(name, { parameter = value, ... })",
    text = "Sets up what plugins ask of each other, which otherwise comes by itself: see `hooke plugins services`.",
    example = "scene:service('neighbours', { skin = 0.3 })" },
  { name = "scene:pin", form = "scene:pin(ids, { path =, rotation =, axes =, normal =, release = })",
    text = "Holds particles: an id, a list of ids or a handle. Without a table they stay where they are.",
    takes = [[
path | m | - | a function of t that gives x, y, z, offsets from the start; vx, vy, vz behind if they are known
rotation | rad | - | a function of t that gives a rotation vector, by which they turn together
center: number[] | m | their middle | about which they turn; it moves with the path
fastest: number | s | - | the least time in which path and rotation change
axes | - | - | a direction along which they slide
normal: number[] | - | - | of a plane in which they slide
release: number | s | never | when they are let go]],
    example = "scene:pin(scene:particle {}, { path = function(t) return 0, 0, 0.1 * math.sin(t) end })" },
  { name = "scene:channel", form = "scene:channel(name, { size =, initial =, rate =, accuracy = })",
    text = "A quantity of each particle beside its position: a temperature, an age, a colour.",
    takes = [[
size: integer | - | 1 | numbers per particle
initial: number|number[] | its own | 0 | at the start: a number, or a list of size numbers
rate: number|function|string | 1/s | 0 | a number r (dy/dt = r y), a function (t, id, y...) of its rates, or a force's name
accuracy: number | its own | - | which the verdict then checks]],
    example = "scene:channel('heat', { initial = 293, rate = -0.1 })" },
  { name = "scene:measure", form = "scene:measure(name, function(state) return number end, { unit = })",
    text = "A figure of each frame, kept in measures.csv, the last one in the summary, with its unit on axes where it is said.",
    takes = "unit: string | - | not said | a short plain text, as \"m\" or \"kg m/s\"; a pure number has none",
    example = "local p = scene:particle {} scene:measure('height', function(s) return s:position(p)[3] end, { unit = 'm' })" },
  { name = "scene:control", form = "scene:control(name, { knots = 31 })", gives = "a function of time",
    text = "A function of time that hooke optimise finds: linear between equally spaced knots, a parameter of the scene.",
    takes = [[
knots | - | required | how many values
duration | s | the scene's | from 0 to where the knots go; afterwards it is constant
start: number|number[]|fun(t: number): number | its own | 0 | the first guess: a number, a list, or a function of time
min: number | its own | none | the least value
max: number | its own | none | the largest value
help | - | - | what it is, and its unit]],
    example = "local f = scene:control('push', { knots = 5 }) scene:force('field', { f = function(t) return f(t), 0, 0 end })" },
  { name = "scene:goal", form = "scene:goal { measure = \"x\", value = 1 }",
    text = "What hooke optimise brings about: a measure of the scene, or a particle's place and velocity, which become measures.",
    takes = [[
measure | - | - | the name of a measure
value: number | its own | - | of that measure
min: number | its own | none | in the place of a value: the least that the measure may be
max: number | its own | none | the largest that it may be
particle: integer | - | - | in the place of a measure
position | m | - | of that particle
velocity | m/s | - | of that particle
at: number | s | the end | when]],
    example = "local p = scene:particle {} scene:goal { particle = p, position = { 1, 0, 0 }, velocity = { 0, 0, 0 } }" },
  { name = "scene:cost", form = "scene:cost(function(state) return number end)",
    text = "What hooke optimise makes least, integrated over the frames, in the place of the controls' squares.",
    example = "local f = scene:control('push', { knots = 5 }) scene:cost(function(s) return f(s.t) ^ 2 end)" },
  { name = "scene:on_frame", form = "scene:on_frame(function(state) ... end)", text = "Is called at each frame.",
    example = "scene:on_frame(function(s) local t = s.t end)" },
  { name = "scene:exact", form = "scene:exact(function(t) return x1, y1, z1, x2, ... end)",
    text = "The known solution, m, of all particles in turn: the summary prints the error at the end, and the verdict uses it.",
    example = "scene:particle { velocity = { 1, 0, 0 } } scene:exact(function(t) return t, 0, 0 end)" },
  { name = "scene:start", form = "scene:start { file = \"state.csv\" }",
    text = "Starts from a file of --state, at t = 0, or from a checkpoint, at its time.",
    takes = "file | - | required | beside the script, or in the output folder" },
  { name = "scene:periodic", form = "scene:periodic { high = { 10, 10, 10 }, axes = \"xyz\" }",
    text = "A box that repeats: what acts between particles takes the nearest images.",
    takes = [[
low | m | {0, 0, 0} | its lower corner
high | m | required | its upper corner
axes: string | - | xyz | the axes along which it repeats]],
    example = "scene:periodic { high = { 10, 10, 10 } }" },
  { name = "scene:within", form = "scene:within({ x, y, z }, { x, y, z })", gives = "a list of ids",
    text = "The particles in a box, between its lower and its upper corner, m.",
    example = "scene:particle {} scene:pin(scene:within({ -1, -1, -1 }, { 1, 1, 1 }))" },
  { name = "scene:run", form = "scene:run { to = 1.0 }", gives = "a run",
    text = "Takes the run of the scene to a time: for scripts that drive their runs, which return nothing.",
    takes = "to: number | s | the duration | when it stops; again, to go on" },
  { name = "run:state", form = "run:state()", gives = "a state", text = "The state of the run now." },
  { name = "run:summary", form = "run:summary()", gives = "a table", text = "The figures of the run, as --json prints them." },
  { name = "run:measures", form = "run:measures()", gives = "a table", text = "The measures of the present time, between frames as well." },
  { name = "run:save", form = "run:save(file)", text = "Writes a checkpoint, from which scene:start goes on." },
  { name = "run:packed", form = "run:packed()", gives = "a text",
    text = "For tools: positions, velocities and channels as 32-bit numbers." },
}

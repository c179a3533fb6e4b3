-- The sun and the outer planets for 200,000 days, 550 years; units: the earth's distance, days, masses of the sun.
local planets = { G = 2.95912208286e-4, duration = 200000, quantities = {} }
local bodies = {
  { "sun", 1.00000597682, { 0, 0, 0 }, { 0, 0, 0 }, { 1.23584254235461, -0.48994382114427, -0.24610536181432 } },
  { "Jupiter", 0.000954786104043, { -3.5023653, -3.8169847, -1.5507963 }, { 0.00565429, -0.00412490, -0.00190589 },
    { 2.61107957011286, -5.07952549678799, -2.24472067785306 } },
  { "Saturn", 0.000285583733151, { 9.0755314, -3.0458353, -1.6483708 }, { 0.00168318, 0.00483525, 0.00192462 },
    { -7.66913624739131, -4.05205224548783, -1.33111566971138 } },
  { "Uranus", 0.0000437273164546, { 8.3101420, -16.2901086, -7.2521278 }, { 0.00354178, 0.00137102, 0.00055029 },
    { -5.82474394984774, 15.33717375357252, 6.78246340991761 } },
  { "Neptune", 0.0000517759138449, { 11.4707666, -25.7294829, -10.8169456 }, { 0.00288930, 0.00114527, 0.00039677 },
    { 20.66398024751502, 20.58295604245987, 7.89479541474820 } },
  { "Pluto", 1 / 1.3e8, { -15.5387357, -25.2225594, -3.1902382 }, { 0.00276725, -0.00170702, -0.00136504 },
    { 36.56695069882260, -13.76768440125963, -15.04346922182326 } },
}

for i, b in ipairs(bodies) do
  planets.quantities[i] = { name = ("x of %s at t = 200,000 d"):format(b[1]), unit = "AU", reference = b[5][1], scale = 1,
    source = "Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4, recomputed with 113 bits" }
end

-- The values of a run with a method and its step, d.
function planets.solve(method, h)
  local scene = hooke.scene { duration = planets.duration, fps = 1 / planets.duration, dt = h, integrator = method }
  for _, b in ipairs(bodies) do scene:particle { position = b[3], velocity = b[4], mass = b[2] } end
  scene:force("nbody", { G = planets.G })
  local s, found = scene:run():state(), {}
  for i in ipairs(bodies) do found[i] = s:position(i)[1] end
  return found
end

return planets

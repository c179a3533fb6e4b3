-- material_numbers: what material = "cotton" stands for, in scene:grid and scene:mesh (areal density, kg/m^2), in the force
-- membrane (N/m), in hinges and quadratic_bending (N m), and in conduction, heating and their kin what melts. A name
-- beside it in the same table goes first. A file of this name beside a scene takes the place of this one.
--
-- What is measured has its source; what is not is said to be derived, or assumed. None of the sources has damping, so none is here.
local materials = {}

-- Wang, O'Brien and Ramamoorthi 2011, Data-driven elastic models for cloth: modeling and measurement, ACM Trans. Graphics
-- 30(4), fabrics of their database as distributed with ARCSim (files materials/NAME.json). Measured there: density,
-- kg/m^2; the elasticity between the stress and Green's strain, N/m, of which these are the entries for the smallest
-- strains, S_u = c11 E_u + c12 E_v, S_v = c12 E_u + c22 E_v, S_uv = c33 E_uv; the bending rigidity at the smallest
-- curvature, N m, along the warp, at 45 degrees and along the weft. Derived: Young's moduli and Poisson's ratio; the
-- shear stiffness against 2 E_uv, c33/2; one rigidity, the mean of the three, since hinges have one for all directions.
local function fabric(what, p)
  local nu = math.max(0, p.c12 / p.c22)
  local sheet = { density = p.density }
  local bending = { rigidity = (p.bending[1] + p.bending[2] + p.bending[3]) / 3 }
  return { what = what, source = "Wang and others 2011, " .. p.name, grid = sheet, mesh = sheet, hinges = bending,
    quadratic_bending = bending,
    membrane = { model = "stvk", stiffness = p.c11 - p.c12 * nu, weft = p.c22 - p.c12 ^ 2 / p.c11, shear = p.c33 / 2,
      nu = nu } }
end

materials.cotton = fabric("woven trousers, 65 % cotton, 35 % polyester", { name = "royal-target", density = 0.220,
  c11 = 2016.55456, c12 = 9.170511, c22 = 2034.97644, c33 = 104.759674, bending = { 125.409805e-6, 107.997696e-6, 125.409805e-6 } })

materials.denim = fabric("jeans, 99 % cotton, 1 % spandex", { name = "11oz-black-denim", density = 0.324,
  c11 = 205.352005, c12 = 10.234077, c22 = 1013.88629, c33 = 53.387184, bending = { 64.196457e-6, 73.384567e-6, 96.951576e-6 } })

materials.polyester = fabric("woven tablecloth, 100 % polyester", { name = "white-dots-on-blk", density = 0.128,
  c11 = 2002.08618, c12 = 0.345588, c22 = 2027.48559, c33 = 19.189022, bending = { 51.713814e-6, 40.659470e-6, 31.282822e-6 } })

materials.knit = fabric("rib knit, 95 % cotton, 5 % spandex", { name = "ivory-rib-knit", density = 0.276,
  c11 = 42.871021, c12 = -0.234556, c22 = 65.166023, c33 = 83.175644, bending = { 46.237591e-6, 30.015930e-6, 32.243889e-6 } })

-- Derived, not measured: silk of 8 momme (1 momme is 4.340 g/m^2). Its fibres, of the density 1340 kg/m^3, the modulus
-- 10 GPa and the thickness d = 11 um, bend freely past one another, half of them along each direction: B = E d^2/16 per
-- area of fibre, (density/2)/1340 of it; friction between fibres makes real ones stiffer, by a few times. Assumed: in its
-- plane it is the woven polyester above.
local function silk()
  local density = 8 * 4.340e-3
  local bending, sheet = { rigidity = density / 2 / 1340 * 10e9 * 11e-6 ^ 2 / 16 }, { density = density }
  return { what = "light plain silk", source = "derived from its fibres; in its plane as polyester", grid = sheet,
    mesh = sheet, membrane = materials.polyester.membrane, hinges = bending,
    quadratic_bending = bending }
end
materials.silk = silk()

-- Treloar 1944, Stress-strain data for vulcanised rubber under various types of deformation, Trans. Faraday Soc. 40:
-- measured is the shear modulus, 0.39 MPa, of the neo-Hookean energy; the volume stays the same. Of a sheet of 0.3 mm, a
-- choice, follow, with 930 kg/m^3: density, Young's modulus 3 G h and the rigidity of a plate, E h^3/(12 (1 - nu^2)).
local function rubber(h)
  local Y = 3 * 0.39e6
  local bending, sheet = { rigidity = Y * h ^ 3 / 9 }, { density = 930 * h }
  return { what = "sheet of natural rubber, 0.3 mm", source = "Treloar 1944", grid = sheet, mesh = sheet,
    membrane = { model = "neo_hookean", stiffness = Y * h, nu = 0.5 }, hinges = bending, quadratic_bending = bending }
end
materials.rubber = rubber(0.3e-3)

-- What melts, in conduction, particle_conduction, grid_conduction, heating and melt: temperatures in K, the heat of
-- melting in J/kg, heat capacities in J/(kg K) and conductivities in W/(m K) of the solid and the melt near the melting point. The density,
-- kg/m^3 of the melt, is for those who lay out particles. `enthalpy` in lib/heat.lua makes an enthalpy of a temperature.
local function melting(what, source, density, law)
  local heating = {}
  for _, name in ipairs { "solidus", "liquidus", "latent", "capacity", "capacity_liquid" } do heating[name] = law[name] end
  return { what = what, source = source, density = density, conduction = law, particle_conduction = law, grid_conduction = law,
    heating = heating, melt = heating }
end

materials.ice = melting("ice and water at one atmosphere",
  "Lide 2004, CRC Handbook of Chemistry and Physics, sections 6 and 12; rounded to three digits", 1000,
  { solidus = 273.15, latent = 333.6e3, capacity = 2100, capacity_liquid = 4220, conductivity = 2.16,
    conductivity_liquid = 0.561 })

materials.gallium = melting("gallium, as melted in the cavity of Gau and Viskanta 1986; the solid as the melt",
  "Brent, Voller and Reid 1988, Numerical Heat Transfer 13, table 1", 6093,
  { solidus = 302.93, latent = 80160, capacity = 381.5, conductivity = 32 })

materials.chocolate = melting("dark chocolate",
  "Beckett 2009, Industrial Chocolate Manufacture and Use, pages 667 and 668, capacities and conductivities at 15 and 40 C; "
    .. "assumed: the melting range of cocoa butter, 27 to 34 C", 1250,
  { solidus = 300, liquidus = 307, latent = 46e3, capacity = 1590, capacity_liquid = 1670, conductivity = 0.22,
    conductivity_liquid = 0.26 })

-- Assumed, not measured: round numbers of the order of those of technical paraffins and of Hawaiian lava.
materials.wax = melting("paraffin wax", "assumed: round numbers of the order of technical paraffins", 780,
  { solidus = 319, liquidus = 329, latent = 200e3, capacity = 2000, capacity_liquid = 2200, conductivity = 0.24,
    conductivity_liquid = 0.15 })
materials.basalt = melting("basaltic lava", "assumed: round numbers of the order of Hawaiian lava", 2700,
  { solidus = 1270, liquidus = 1470, latent = 600e3, capacity = 1100, capacity_liquid = 1200, conductivity = 1.5,
    conductivity_liquid = 1 })

return materials

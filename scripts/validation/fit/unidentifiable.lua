-- Mass and stiffness of a free oscillation: its places say k/m alone, and the fit has to say so.
local validation = require("validation")

return validation.problem {
  title = "What data do not determine",
  quantities = {
    { name = "k/m", unit = "1/s^2", reference = 40, source = "the data's own" },
    { name = "pairs that are named", reference = 1, source = "x(t) depends on k/m alone" },
  },
  space = { 10, 20, 40 },
  tolerance = 1e-4,
  noise = 1e-3,
  why = "the fit's accuracy by the steps, 1e-3, of which its refinement leaves a tenth",
  quick = false,
  asks = function(at)
    local lines = { "t,x" }
    for k = 1, at.n do lines[k + 1] = ("%.17g,%.17g"):format(2 * k / at.n, math.cos(math.sqrt(40) * 2 * k / at.n)) end
    return { command = "fit", words = { "--by", "k,m" }, data = table.concat(lines, "\n") .. "\n", script = [[
      local k, m = param("k", 75, "N/m", { min = 1 }), param("m", 2, "kg", { min = 0.1 })
      local scene = hooke.scene { duration = 2, fps = 10, integrator = "rk4", dt = 0.01 }
      local p = scene:particle { position = { 1, 0, 0 }, mass = m }
      scene:force("central", { strength = k, per = "particle" })
      scene:measure("x", function(s) return s:position(p)[1] end)
      return scene]] }
  end,
  solve = function(at)
    local best, named = at.found.minima[1], 0
    for _, sentence in ipairs(at.found.doubts) do
      if sentence:find("do not tell the two apart", 1, true) and sentence:find("k by +1 %, m by +1 %", 1, true) then named = named + 1 end
    end
    return { best.parameters.k.value / best.parameters.m.value, named }
  end,
}

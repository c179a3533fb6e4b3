-- hooke optimise SCENE.lua [--goal x=1,v=0] [--by NAME,NAME] [name=value ...]: the controls that reach goals with least effort.
-- Controls are functions of time, scene:control(); goals are of the scene, scene:goal{}, or measures at the end;
-- the effort is the integral of the controls' squares, or what scene:cost() says. By gradients of the steps taken (one adjoint a
-- goal), from several starts; every optimum is run again by an independent method, and what it misses is said. One that was
-- interrupted goes on where it was. In the place of the scene may stand a script that says all of this: return hooke.optimise {
-- scene = "FILE.lua", goal = { x = 1 }, found = function(optimum) ... end }.
local argparse = require("argparse")
local asked = require("common.optimise.asked")
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local description = require("common.run.description")
local files = require("common.run.file")
local interruption = require("common.run.interruption")
local journal = require("common.bench.journal")
local memory = require("common.optimise.memory")
local report = require("common.optimise.report")
local search = require("common.optimise.search")

-- The method that runs an optimum again: it chooses its steps, which are not those of the optimisation.
local independent, independent_tolerance = "dop853", 1e-11

local function complain(format, ...) return command_line.complain("optimise", format:format(...)) end

local function parser()
  local p = argparse("hooke optimise", "The controls that bring a scene to goals with least effort.")
  p:argument("scene", "the scene's script, or one with hooke.optimise{}, and values of parameters, name=value"):args("+")
  p:option("--goal", "measures and the values that they shall have, x=1,v=0, in the place of the scene's goals"):count("*")
  p:option("--by", "the controls (all that the scene has)"):count("*")
  p:option("--at", "s, the time of the goals of --goal (the end)"):convert(command_line.positive("--at"))
  for _, more in ipairs { { "--starts", "how many random guesses, beside the scene's own" },
    { "--refine", "how often the best optimum is found again with knots half as far apart" } } do
    p:option(more[1], more[2]):default("0"):convert(function(text)
      if text == "0" then return 0 end
      return command_line.whole(more[1])(text) -- with the reason of a refusal
    end)
  end
  p:option("--way", "shooting: the values of the controls are unknown; transcription: those and all states at knots")
    :choices { "shooting", "transcription" }:default("shooting")
  p:option("--guess", "of transcription, of the states at knots: those of the run, or that the scene stands still")
    :choices { "run", "still" }:default("run")
  p:option("--through", "of transcription: PARAMETER=FROM,...,TO: the optimum at TO by way of the others, each from those before")
  p:option("--most", "iterations, of each start"):default("100"):convert(command_line.whole("--most"))
  p:option("--tolerance", "of the controls, relative"):default("1e-7"):convert(command_line.positive("--tolerance"))
  p:option("--accuracy", "how far the independent method may miss a goal, relative"):default("1e-3")
    :convert(command_line.positive("--accuracy"))
  p:option("--integrator", "in place of the scene's")
  p:option("--without", "the label of a plugin that is left out"):count("*")
  p:option("--dt", "s, the longest step"):convert(command_line.positive("--dt"))
  p:option("--out", "where the results go (out/optimise/SCENE)")
  p:flag("--trust", "the scene may use plugins beside it")
  p:flag("--json", "the result as JSON on standard output")
  p:flag("--quiet", "no progress")
  return p
end

-- What hooke.optimise{} of a script may say.
local fields = { scene = "scene", params = "params", goal = "numbers", by = "list", without = "list", at = "option",
  starts = "option", guess = "option", through = "option", refine = "option", way = "option", most = "option",
  tolerance = "option", accuracy = "option", integrator = "option", dt = "option" }

local function options()
  local o, why = description.parse("optimise", parser, fields)
  if not o then return nil, why end
  local fine
  fine, why = command_line.take_scene("optimise", o)
  if not fine then return nil, why end
  if o.way ~= "transcription" and (o.guess ~= "run" or o.through) then
    return nil, "--guess and --through are for --way transcription"
  end
  fine, why = asked.read_through(o)
  if not fine then return nil, why end
  o.goals, why = asked.goals(o.goal)
  if not o.goals then return nil, why end
  o.independent = independent
  return o
end

-- What has been found so far stands in the results' folder, and the best controls of every moment.
local function open_memory(o)
  local why
  local made, refused = files.make_folder(o.out)
  if not made then return nil, refused end
  o.memory, why = memory.open(o.out .. "/evaluations.json", journal.of_scene(o.scene, o.params) .. journal.canonical { o.controls,
    o.goals, o.cost or "", o.integrator or "", o.dt or "", o.without })
  o.keep = function(controls, cost, missing) report.keep(o, controls, cost, missing) end
  return o.memory, why
end

local function ready(o)
  local explained, why = case_process.explain(o.scene, o.params, { trust = o.trust, integrator = o.integrator,
    without = o.without })
  if not explained then return nil, why end
  local fine
  fine, why = asked.choose_controls(o, explained)
  if not fine then return nil, why end
  if o.at and o.at > explained.duration then
    return nil, ("--at: %g s is after the scene's duration, %g s"):format(o.at, explained.duration)
  end
  local start = case_process.run { scene = o.scene, params = o.params, integrator = o.integrator, trust = o.trust,
    without = o.without, ["until"] = 0, explained = explained }
  if not start.measures then return nil, start.failed end
  o.plugin, o.fps = start.integrator, explained.fps
  fine, why = asked.choose_goals(o, explained, start.measures)
  if not fine then return nil, why end
  fine, why = asked.choose_stages(o, function(params)
    return case_process.explain(o.scene, params, { trust = o.trust, integrator = o.integrator, without = o.without })
  end)
  if not fine then return nil, why end
  return open_memory(o)
end

local now -- what is being optimised

local function main()
  local o, why = options()
  if not o then return why and complain("%s", why) or 1 end
  local fine
  now = o
  fine, why = ready(o)
  if not fine then return complain("%s", why) end
  local optima
  optima, why = search.optima(o)
  if not optima then return complain("%s", why) end
  for _, optimum in ipairs(optima) do
    search.replay(o, optimum, independent, independent_tolerance)
    optimum.doubts = report.doubts(o, optimum)
  end
  fine, why = report.write(o, optima)
  if not fine then
    complain("%s", why)
    return o.unanswered and 1 or 4
  end
  o.memory:remove()
  return #optima[1].doubts == 0 and 0 or 2
end

return interruption.guard("optimise", main, function()
  if now and now.bar then now.bar:finish() end
  return report.interrupted(now or {})
end)

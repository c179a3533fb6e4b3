-- Runs of a scene at other values of its parameters, that give its measures at the times of observations: each in a process
-- of its own, several at a time, and none twice, also not after an interruption, where there is a journal.
local case_process = require("common.run.case_process")
local process = require("process")
local shape = require("common.fit.shape")

local runs = {}
runs.__index = runs

-- In the process of a case: what the observations are of, as texts, since JSON keeps fewer digits.
local function execute(case)
  if case.shape and case.shape.rest then return shape.at_rest(case) end
  local scene, refused = hooke.load(case.scene, case.params, { integrator = case.integrator, solver = case.solver, dt = case.dt,
    tol = case.tol, seed = case.seed, threads = 1, trust = case.trust, output = false })
  if not scene then return { failed = refused } end
  local values, run, t, measured = {}, nil, nil, nil
  for k, o in ipairs(case.observations) do
    if o.t ~= t then
      local fine, found = pcall(scene.run, scene, { to = o.t })
      if not fine then return { failed = (tostring(found):gsub("^[^\n]-:%d+: (run: to: )", "%1")) } end -- this file is no place
      run, t, measured = found, o.t, found:measures()
    end
    if case.shape then break end
    if not measured[o.name] then return { failed = ("the measure '%s' is not finite at t = %g s"):format(o.name, o.t) } end
    values[k] = ("%.17g"):format(measured[o.name])
  end
  local s = run:summary()
  if s.verdict == "diverged" then return { failed = s.reason or "it diverged" } end
  if case.shape then
    local why
    values, why = shape.at_time(run, case)
    if not values then return { failed = why } end
  end
  return { values = values, dt = ("%.17g"):format(s.dt_max) }
end

-- options: scene, names (of the parameters), observations (in the order of time), given (other parameters), trust, seed,
-- shape ({ rest = } or nil: the observations are places of particles, all at one time, or at rest), integrator, solver, adaptive,
-- journal, jobs, timeout, tick(), priors ({ mean =, sd = } or false of
-- each parameter, or nil). `level`: how often the step has been halved, or the
-- tolerance of an adaptive method, at first `tol`, made a tenth.
function runs.new(options)
  local self = setmetatable({ known = {}, count = 0, level = 0 }, runs)
  for key, value in pairs(options) do self[key] = value end
  return self
end

local function case_of(self, p, setting)
  local params = {}
  for name, value in pairs(self.given) do params[name] = value end
  for j, name in ipairs(self.names) do params[name] = ("%.17g"):format(p[j]) end
  return { scene = self.scene, params = params, integrator = self.integrator, solver = self.solver, dt = setting.dt,
    tol = setting.tol, seed = self.seed, trust = self.trust, observations = self.observations, execute = execute, shape = self.shape,
    timeout = self.timeout }
end

local function key_of(p, setting)
  local words = { ("dt %a tol %a"):format(setting.dt or 0, setting.tol or 0) }
  for j, x in ipairs(p) do words[1 + j] = ("%a"):format(x) end
  return table.concat(words, " ")
end

-- Results of the points, { values, dt } (texts) or { failed }. setting: { dt =, tol = } of the runs; what is nil is the
-- scene's or hooke's choice.
function runs:results(points, setting)
  local keys, waiting = {}, {}
  for k, p in ipairs(points) do
    keys[k] = key_of(p, setting)
    self.known[keys[k]] = self.known[keys[k]] or self.journal and self.journal:get(keys[k])
    if not self.known[keys[k]] then
      self.known[keys[k]] = {}
      local case = case_of(self, p, setting)
      case.key = keys[k]
      waiting[#waiting + 1] = case
    end
  end
  local n = 0
  case_process.each(self.jobs or process.processors(), function()
    n = n + 1
    return waiting[n]
  end, function(case, result)
    self.known[case.key] = result
    self.count = self.count + 1
    if self.journal then self.journal:put(case.key, result) end
  end, self.tick)
  local list = {}
  for k, key in ipairs(keys) do list[k] = self.known[key] end
  return list
end

-- The setting of runs at a level. Those of differences have the steps of the run at `base`: steps that are chosen for each
-- would jump with the parameters.
function runs:setting(base, level, differences)
  if self.shape and self.shape.rest then return {} end
  if self.adaptive then return { tol = self.tol / 10 ^ level } end
  if level == 0 and not differences then return {} end
  local chosen = self:results({ base }, {})[1]
  self.dt = tonumber(chosen.dt) or self.dt
  return { dt = self.dt / 2 ^ level }
end

-- (what the scene says - what was measured)/sd of each observation, and behind them (parameter - mean)/sd of each prior; or
-- false and why.
local function residuals_of(self, result, p)
  if not result.values then return false, result.failed end
  local r = {}
  for k, o in ipairs(self.observations) do r[k] = (tonumber(result.values[k]) - o.value) / (o.sd or 1) end
  for j = 1, #p do
    local prior = self.priors and self.priors[j]
    if prior then r[#r + 1] = (p[j] - prior.mean) / prior.sd end
  end
  return r
end

-- Lists of residuals and of reasons, as common/fit/least_squares.lua asks for them; of the level, or of another one.
function runs:residuals(points, base, level)
  local setting = self:setting(base, level or self.level, #points > 1)
  local list, why = {}, {}
  for k, result in ipairs(self:results(points, setting)) do list[k], why[k] = residuals_of(self, result, points[k]) end
  return list, why
end

return runs

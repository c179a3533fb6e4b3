-- The results of sweeps in SQLite: one transaction a case, so that a process may be killed at any moment without loss
-- of finished cases. A case is found by the digest of its description (sweep/digest.lua), and the description is stored
-- as well, so that two different cases are never confused. Several sweeps may share a database and cases.
local database = require("common.sweep.database")
local digest = require("common.sweep.digest")
local lfs = require("lfs")

local store = {}
store.__index = store

-- The figures of a run's summary that are stored, { column, type, key in the summary }.
store.reported = {
  { "t", "REAL", unit = "s" }, { "particles", "INTEGER" }, { "steps", "INTEGER" }, { "force_evaluations", "INTEGER" },
  { "jacobian_evaluations", "INTEGER" }, { "factorizations", "INTEGER" }, { "linear_iterations", "INTEGER" },
  { "dt_min", "REAL", unit = "s" }, { "dt_max", "REAL", unit = "s" }, { "wall_s", "REAL", unit = "s" },
  { "step_wall_s", "REAL", unit = "s" }, { "energy_drift", "REAL", "energy.drift" }, { "momentum_drift", "REAL" },
  { "constraint_violation", "REAL", unit = "m" }, { "max_strain", "REAL" }, { "exact_error", "REAL", unit = "m" },
  { "verify_difference", "REAL", unit = "m" }, { "process_s", "REAL", unit = "s" },
}

local fixed = { "key TEXT NOT NULL UNIQUE", "description TEXT NOT NULL", "scene TEXT NOT NULL", "integrator TEXT",
  "solver TEXT", "dt REAL", "tol REAL", "repeat INTEGER", "verdict TEXT NOT NULL", "reason TEXT", "finished TEXT" }

local function names(list)
  local out = {}
  for k, column in ipairs(list) do out[k] = type(column) == "table" and column[1] or column:match("^%S+") end
  return out
end

local columns = table.concat(names(fixed), ", ") .. ", " .. table.concat(names(store.reported), ", ")

local function schema()
  local reported = {}
  for k, column in ipairs(store.reported) do reported[k] = column[1] .. " " .. column[2] end
  return {
    "CREATE TABLE IF NOT EXISTS sweeps (id INTEGER PRIMARY KEY, name TEXT NOT NULL, definition TEXT NOT NULL, " ..
      "started TEXT, UNIQUE (name, definition))",
    "CREATE TABLE IF NOT EXISTS cases (id INTEGER PRIMARY KEY, " .. table.concat(fixed, ", ") .. ", " ..
      table.concat(reported, ", ") .. ")",
    "CREATE TABLE IF NOT EXISTS params (case_id INTEGER REFERENCES cases, name TEXT, value, " ..
      "PRIMARY KEY (case_id, name)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS measures (case_id INTEGER REFERENCES cases, name TEXT, value REAL, " ..
      "PRIMARY KEY (case_id, name)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS paths (case_id INTEGER REFERENCES cases, particle INTEGER, frame INTEGER, t REAL, " ..
      "x REAL, y REAL, z REAL, PRIMARY KEY (case_id, particle, frame)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS members (sweep_id INTEGER REFERENCES sweeps, number INTEGER, " ..
      "case_id INTEGER REFERENCES cases, PRIMARY KEY (sweep_id, number)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS warnings (case_id INTEGER REFERENCES cases, number INTEGER, text TEXT, " ..
      "PRIMARY KEY (case_id, number)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS states (case_id INTEGER PRIMARY KEY REFERENCES cases, digest TEXT)",
    "CREATE TABLE IF NOT EXISTS units (case_id INTEGER REFERENCES cases, name TEXT, unit TEXT, " ..
      "PRIMARY KEY (case_id, name)) WITHOUT ROWID", -- of measures and parameters
  }
end

local version = 1

function store.exists(path)
  return lfs.attributes(path, "mode") == "file"
end

local function make_folder(path)
  local folder = path:match("^(.*)/[^/]*$")
  if not folder or folder == "" or lfs.attributes(folder, "mode") then return end
  make_folder(folder)
  local fine, why = lfs.mkdir(folder)
  if not fine and not lfs.attributes(folder, "mode") then
    database.fail("cannot make the folder %s: %s", folder, why)
  end
end
store.make_folder = make_folder

local function has_table(db, schema_name, name)
  return db:value(("SELECT count(*) FROM %s.sqlite_master WHERE name = '%s'"):format(schema_name, name)) > 0
end

function store.open(path, journal)
  make_folder(path)
  local self = setmetatable({ path = path, db = database.open(path, journal) }, store)
  local found = self.db:value("PRAGMA user_version")
  if found ~= 0 and found ~= version then
    database.fail("%s has tables of version %d and this hooke writes %d: take another file", path, found, version)
  end
  if not has_table(self.db, "main", "units") then -- a new file, or one of a hooke that kept fewer tables
    self.db:transaction(function()
      for _, sql in ipairs(schema()) do self.db:execute(sql) end
      self.db:execute("PRAGMA user_version = " .. version)
    end)
  end
  return self
end

function store:close() self.db:close() end

-- ---- identification of cases ----

local function text_of(value)
  return math.type(value) == "float" and ("%.17g"):format(value) or tostring(value)
end

local said = { "solver", "integrator", "dt", "tol", "until", "accuracy", "verify", "seed", "step_limit" }

-- The text of all that a case's result depends on. (Composed on demand: the part that is common to cases is long.)
local function description_of(case)
  return case.grounds .. "\n" .. case.settings
end

-- Gives every case its key. plugins: hooke.catalogue(); paths: ids of particles.
function store.identify(cases, plugins, paths)
  for _, case in ipairs(cases) do
    local lines, keys = {}, {}
    for name in pairs(case.params) do keys[#keys + 1] = name end
    table.sort(keys)
    for _, name in ipairs(keys) do lines[#lines + 1] = ("param %s = %s"):format(name, text_of(case.params[name])) end
    for _, name in ipairs(said) do
      if case[name] ~= nil then lines[#lines + 1] = ("%s = %s"):format(name, text_of(case[name])) end
    end
    if case["repeat"] > 1 then lines[#lines + 1] = "repeat = " .. case["repeat"] end
    if paths then lines[#lines + 1] = "paths = " .. table.concat(paths, ",") end
    case.grounds, case.settings = digest.grounds(case, plugins), table.concat(lines, "\n")
    case.key = digest.of(description_of(case))
  end
end

-- Rows of a query that ends in "IN", for some hundred values at a time.
local function rows_in(db, query, values)
  return coroutine.wrap(function()
    for at = 1, #values, 500 do
      local list = table.concat(values, ",", at, math.min(at + 499, #values))
      for row in db:rows(("%s (%s)"):format(query, list)) do coroutine.yield(row) end
    end
  end)
end

-- Marks the cases that are done: case.row = its id. Returns how many.
function store:find(cases)
  local by_key, keys, count = {}, {}, 0
  for k, case in ipairs(cases) do
    by_key[case.key] = case
    keys[k] = database.quote(case.key)
  end
  local clash
  for row in rows_in(self.db, "SELECT id, key, description FROM cases WHERE key IN", keys) do
    if row.description ~= description_of(by_key[row.key]) then clash = row.key end
    by_key[row.key].row = row.id
  end
  if clash then
    database.fail("%s: two different cases have the key %s; take another file with --db", self.path, clash)
  end
  for _, case in ipairs(cases) do
    case.row = by_key[case.key].row -- also for cases with equal keys
    if case.row then count = count + 1 end
  end
  return count
end

-- ---- writing ----

function store:begin(name, definition)
  local db, q = self.db, database.quote
  db:transaction(function()
    db:execute("INSERT OR IGNORE INTO sweeps (name, definition, started) VALUES (" ..
      ("%s, %s, datetime('now'))"):format(q(name), q(definition)))
  end)
  self.sweep = db:value(("SELECT id FROM sweeps WHERE name = %s AND definition = %s"):format(q(name), q(definition)))
end

local function reported_values(result)
  local values = {}
  for k, column in ipairs(store.reported) do
    local value = result
    for part in (column[3] or column[1]):gmatch("[^.]+") do value = type(value) == "table" and value[part] or nil end
    values[k] = database.quote(type(value) == "number" and value or nil)
  end
  return table.concat(values, ",")
end

local function first_of(...)
  for k = 1, select("#", ...) do
    local value = select(k, ...)
    if value and value ~= "" then return value end
  end
end

-- The end of a case: the run's verdict; "refused" before the first step; "failed" by an error of the script or of a
-- plugin; "crashed" or "timeout" of its process.
local stopped = { interrupted = true, running = true, ok = true, inaccurate = true }

function store.verdict(result, case)
  if result.fits == false then return "refused" end
  if result.verdict == "interrupted" and case.step_limit then return "interrupted" end
  if result.failed and (not result.verdict or stopped[result.verdict]) then return "failed" end
  return result.verdict or "failed"
end

local function insert_rows(db, into, rows)
  if #rows > 0 then db:execute(("INSERT INTO %s VALUES %s"):format(into, table.concat(rows, ","))) end
end

local function insert_numbers(db, into, id, numbers)
  local rows = {}
  for name, value in pairs(numbers or {}) do rows[#rows + 1] = database.tuple(3, id, name, value) end
  insert_rows(db, into, rows)
end

local function insert_warnings(db, id, warnings)
  local rows = {}
  for k, text in ipairs(warnings or {}) do rows[k] = database.tuple(3, id, k, text) end
  insert_rows(db, "warnings", rows)
end

local function insert_paths(db, id, points)
  local rows = {}
  for _, p in ipairs(points or {}) do rows[#rows + 1] = database.tuple(7, id, table.unpack(p, 1, 6)) end
  insert_rows(db, "paths", rows)
end

-- Of measures and parameters. A hooke that knows no units leaves them when it deletes a case, whose number may come again.
local function insert_units(db, id, result)
  db:execute("DELETE FROM units WHERE case_id = " .. id)
  local rows, seen = {}, {}
  for _, units in ipairs { result.measure_units or {}, result.parameter_units or {} } do
    for name, unit in pairs(units) do
      if not seen[name] then rows[#rows + 1] = database.tuple(3, id, name, unit) end
      seen[name] = true
    end
  end
  insert_rows(db, "units", rows)
end

function store:link(case)
  self.db:execute("INSERT OR REPLACE INTO members VALUES " .. database.tuple(3, self.sweep, case.number, case.row))
end

-- A case and its result, as one transaction. When another process has stored the same case already, its row is kept.
function store:add(case, result)
  local db = self.db
  db:transaction(function()
    case.row = db:value("SELECT id FROM cases WHERE key = " .. database.quote(case.key))
    if case.row then return self:link(case) end
    local known = database.tuple(10, case.key, description_of(case), case.values.scene,
      first_of(result.integrator, case.integrator), first_of(result.solver, case.solver), case.dt,
      case.tol, case["repeat"], store.verdict(result, case), first_of(result.failed, result.reason))
    db:execute(("INSERT INTO cases (%s) VALUES (%s, datetime('now'), %s)"):format(columns, known:sub(2, -2),
      reported_values(result)))
    case.row = db:value("SELECT last_insert_rowid()")
    insert_numbers(db, "params", case.row, case.params)
    insert_numbers(db, "measures", case.row, result.measures)
    insert_units(db, case.row, result)
    insert_paths(db, case.row, result.paths)
    insert_warnings(db, case.row, result.warnings)
    if result.state then insert_rows(db, "states", { database.tuple(2, case.row, result.state) }) end
    self:link(case)
  end)
end

-- Adds to the sweep its cases that were done before, perhaps by another sweep.
function store:link_all(cases)
  self.db:transaction(function()
    for _, case in ipairs(cases) do
      if case.row then self:link(case) end
    end
  end)
end

-- The cases whose process crashed or exceeded its time.
function store:broken(cases)
  local list, bad = {}, {}
  for row in self.db:rows("SELECT id FROM cases WHERE verdict IN ('crashed', 'timeout')") do bad[row.id] = true end
  for _, case in ipairs(cases) do
    if bad[case.row] then list[#list + 1] = case end
  end
  return list
end

-- Deletes the results of these cases.
function store:forget(cases)
  self.db:transaction(function()
    for _, case in ipairs(cases) do
      for _, name in ipairs { "params", "measures", "paths", "members", "warnings", "states", "units" } do
        if case.row then self.db:execute(("DELETE FROM %s WHERE case_id = %d"):format(name, case.row)) end
      end
      if case.row then self.db:execute(("DELETE FROM cases WHERE id = %d"):format(case.row)) end
      case.row = nil
    end
  end)
end

-- ---- merging ----

-- remarked: the other database has the tables `warnings` and `states`; measured: `units`.
local function merge_statements(remarked, measured)
  local fresh = "IN (SELECT key FROM temp.fresh)"
  local same = "JOIN part.cases c ON c.id = p.case_id JOIN main.cases m ON m.key = c.key WHERE c.key " .. fresh
  local list = {
    ("INSERT INTO main.cases (%s) SELECT %s FROM part.cases WHERE key %s"):format(columns, columns, fresh),
    "INSERT INTO main.params SELECT m.id, p.name, p.value FROM part.params p " .. same,
    "INSERT INTO main.measures SELECT m.id, p.name, p.value FROM part.measures p " .. same,
    "INSERT INTO main.paths SELECT m.id, particle, frame, p.t, x, y, z FROM part.paths p " .. same,
    "INSERT OR IGNORE INTO main.sweeps (name, definition, started) SELECT name, definition, started FROM part.sweeps",
    "INSERT OR IGNORE INTO main.members SELECT ms.id, p.number, m.id FROM part.members p " ..
      "JOIN part.sweeps ps ON ps.id = p.sweep_id " ..
      "JOIN main.sweeps ms ON ms.name = ps.name AND ms.definition = ps.definition " ..
      "JOIN part.cases c ON c.id = p.case_id JOIN main.cases m ON m.key = c.key",
  }
  if remarked then
    list[#list + 1] = "INSERT INTO main.warnings SELECT m.id, number, text FROM part.warnings p " .. same
    list[#list + 1] = "INSERT INTO main.states SELECT m.id, p.digest FROM part.states p " .. same
  end
  if measured then
    list[#list + 1] = "INSERT OR REPLACE INTO main.units SELECT m.id, p.name, p.unit FROM part.units p " .. same
  end
  return list
end

local function merge_attached(self, path)
  local db = self.db
  local found = db:value("PRAGMA part.user_version")
  if found == 0 then return 0 end -- the writing process was killed before its first case
  if found ~= version then
    database.fail("%s has tables of version %d, %s of %d", path, found, self.path, version)
  end
  local clash = db:value("SELECT c.key FROM part.cases c JOIN main.cases m ON m.key = c.key " ..
    "WHERE m.description <> c.description")
  if clash then database.fail("%s and %s: two different cases have the key %s", self.path, path, clash) end
  db:execute("DROP TABLE IF EXISTS temp.fresh")
  db:execute("CREATE TEMP TABLE fresh AS SELECT key FROM part.cases WHERE key NOT IN (SELECT key FROM main.cases)")
  local count = db:value("SELECT count(*) FROM temp.fresh")
  db:transaction(function()
    for _, sql in ipairs(merge_statements(has_table(db, "part", "states"), has_table(db, "part", "units"))) do db:execute(sql) end
  end)
  return count
end

-- Merges the results of another database of sweeps; returns the number of new cases.
function store:merge(path)
  if not store.exists(path) then database.fail("cannot merge %s: there is no such file", path) end
  local known, cause = pcall(self.db.execute, self.db, "ATTACH DATABASE " .. database.quote(path) .. " AS part")
  if not known then database.fail("cannot merge %s: %s", path, tostring(cause):match("[^:]*$"):gsub("^ ", "")) end
  local fine, count = pcall(merge_attached, self, path)
  pcall(self.db.execute, self.db, "DETACH DATABASE part")
  if not fine then error(count, 0) end
  return count
end

-- ---- reading ----

-- Sets case.result = { verdict =, reason =, [column] = value, measures = { name = value }, units = { name = unit } of measures
-- and parameters, warnings = { text }, state = digest of the last positions and velocities or nil } of the cases that are done.
function store:read(cases)
  local results, ids = {}, {}
  for _, case in ipairs(cases) do
    if case.row and not results[case.row] then
      results[case.row] = { measures = {}, units = {}, warnings = {} }
      ids[#ids + 1] = case.row
    end
    case.result = results[case.row]
  end
  for row in rows_in(self.db, "SELECT id, " .. columns .. " FROM cases WHERE id IN", ids) do
    for name, value in pairs(row) do results[row.id][name] = value end
  end
  for row in rows_in(self.db, "SELECT case_id, name, value FROM measures WHERE case_id IN", ids) do
    results[row.case_id].measures[row.name] = row.value
  end
  for row in rows_in(self.db, "SELECT case_id, name, unit FROM units WHERE case_id IN", ids) do
    results[row.case_id].units[row.name] = row.unit
  end
  for row in rows_in(self.db, "SELECT case_id, number, text FROM warnings WHERE case_id IN", ids) do
    results[row.case_id].warnings[row.number] = row.text
  end
  for row in rows_in(self.db, "SELECT case_id, digest FROM states WHERE case_id IN", ids) do
    results[row.case_id].state = row.digest
  end
end

-- The path of a particle, { { t, x, y, z }, ... }.
function store:path_of(case, particle)
  local points = {}
  for p in self.db:rows("SELECT t, x, y, z FROM paths WHERE " ..
    ("case_id = %d AND particle = %d ORDER BY frame"):format(case.row, particle)) do
    points[#points + 1] = p
  end
  return points
end

return store

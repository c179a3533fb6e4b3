-- SQLite through luasql: a database that is opened with its schema, transactions, rows as tables. A failed call raises
-- an error with SQLite's message and the file's name. Several processes may write at the same time: each waits for the
-- others.
local database = {}
database.__index = database

local patience = 60 -- seconds that a process waits for others that write

-- Errors of files: a text with the exit code of hooke for them. That SQLite has no memory is not the file's fault.
local failure = { __tostring = function(e) return e.text end }

function database.fail(text, ...)
  text = text:format(...)
  error(setmetatable({ text = text, code = text:find("out of memory$") and 1 or 4 }, failure), 0)
end

local driver

local function sqlite()
  local fine, module = pcall(require, "luasql.sqlite3")
  if not fine then
    error("Lua's SQLite library luasql.sqlite3 (Debian: lua-sql-sqlite3) is missing: tools/install-deps run gets it", 0)
  end
  driver = driver or module.sqlite3()
  return driver
end

-- A value as SQL text; nil is NULL. SQL text ends at a zero byte, which is therefore written as \0.
function database.quote(value)
  if value == nil then return "NULL" end
  if math.type(value) == "integer" then return ("%d"):format(value) end
  if type(value) == "number" then
    if value ~= value then return "NULL" end
    if value == math.huge then return "9e999" end
    return value == -math.huge and "-9e999" or ("%.17g"):format(value):gsub("^(-?%d+)$", "%1.0")
  end
  return "'" .. tostring(value):gsub("'", "''"):gsub("\0", "\\0") .. "'"
end

-- (v, v, ...) for n values, some of which may be nil.
function database.tuple(n, ...)
  local list = {}
  for k = 1, n do list[k] = database.quote((select(k, ...))) end
  return "(" .. table.concat(list, ",") .. ")"
end

-- Changes the file's journal. Of two processes that do so at the same time SQLite refuses one at once, without the wait of
-- busy_timeout, as each holds the lock that the other one waits for. It waits for a transaction, then, and asks again.
local function change_journal(db, journal)
  local last = os.time() + patience
  while true do
    local fine, message = pcall(db.execute, db, "PRAGMA journal_mode = " .. journal)
    if fine then return end
    if not tostring(message):find("locked") or os.time() > last then error(message, 0) end
    db:transaction(function() end)
  end
end

-- journal: "wal" (the default: readers do not wait, a commit costs no fsync) or "delete", for network file systems,
-- where a write-ahead log does not work.
function database.open(path, journal)
  local connection, message = sqlite():connect(path)
  if not connection then database.fail("cannot open the database %s: %s", path, message) end
  local db = setmetatable({ connection = connection, path = path }, database)
  db:execute("PRAGMA busy_timeout = " .. patience * 1000)
  change_journal(db, journal or "wal")
  db:execute("PRAGMA synchronous = NORMAL") -- with the log, only a crash of the whole machine may lose the last rows
  return db
end

local function run(db, sql)
  local result, message = db.connection:execute(sql)
  if not result then database.fail("%s: %s", db.path, (message:gsub("^LuaSQL: ", ""))) end
  return result
end

function database:execute(sql)
  local result = run(self, sql)
  if type(result) == "userdata" then result:close() end
end

-- for row in db:rows(sql): tables by the names of the columns.
function database:rows(sql)
  local cursor = run(self, sql)
  return function() return cursor:fetch({}, "a") end -- the driver closes the cursor at its end
end

-- The first column of the first row, or nil.
function database:value(sql)
  local cursor = run(self, sql)
  local value = cursor:fetch()
  if value ~= nil then cursor:close() end
  return value
end

-- Calls `act` in one transaction: all of its changes are made, or none.
function database:transaction(act)
  self:execute("BEGIN IMMEDIATE")
  local fine, message = pcall(act)
  if not fine then
    pcall(self.execute, self, "ROLLBACK")
    error(message, 0)
  end
  self:execute("COMMIT")
end

function database:close()
  self.connection:close()
end

return database

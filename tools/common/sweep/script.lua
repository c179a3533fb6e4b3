-- Reading a sweep script. It only describes a sweep, so it runs as untrusted scenes do, in a sandbox with their limits
-- (hooke.definition): math, string, table, param, require for modules beside it and in scripts/lib, and hooke.sweep,
-- which takes the table that it returns.
local script = {}

-- The definition that the script at `path` returns.
function script.read(path)
  local name = path:match("[^/]*$")
  local definition, message = hooke.definition(path, "sweep")
  if not definition then error(message, 0) end
  if definition.trust ~= nil then
    error(name .. ": trust: a script cannot lift the sandbox of its scenes; --trust on the command line can", 0)
  end
  definition.folder = path:match("^(.*)/[^/]*$") or "."
  return definition
end

return script

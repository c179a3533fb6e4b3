-- Attempts of scenes to get out of their sandbox or to crash hooke; see tests/support/attempts/run.lua. Arguments: a part
-- of an attempt's name, and themes.
package.path = (os.getenv("HK_ROOT") or ".") .. "/tests/support/?.lua;" .. package.path
local themes = { table.unpack(arg, 2) }
if #themes == 0 then themes = { "escape", "memory", "files", "text" } end
os.exit(require("attempts.run")(themes, arg[1]))

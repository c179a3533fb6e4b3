-- The orderly end of a tool that is asked to stop (Ctrl-C, SIGTERM) while it waits for its runs: these are ended, and it says in one
-- sentence what it keeps. A second signal, half a second later, ends it at once.
local case_process = require("common.run.case_process")
local command_line = require("common.run.command_line")
local process = require("process")

local interruption = {}

interruption.code = 130 -- as hooke run ends

-- What main() returns; or the exit code of an interruption, after the sentence that words() gives. tool: its name.
function interruption.guard(tool, main, words)
  case_process.stop_at(process.signals(true))
  local fine, result = pcall(main)
  if fine then return result end
  if result ~= case_process.interrupted then error(result, 0) end
  command_line.complain(tool, "interrupted" .. words())
  return interruption.code
end

return interruption

-- What `make bench` prints beside its figures: at the head the processor that they are of, its vectors, caches and load; with
-- the name of a bench what README.md says of it, so that figures stand beside those of another machine.
-- Usage: lua5.4 tests/bench/machine.lua [NAME]     (from the root)
local function read(path)
  local file = io.open(path)
  local text = file and file:read("a") or ""
  if file then file:close() end
  return (text:gsub("%s+$", ""))
end

-- Of /proc/cpuinfo: the name, or the part's number where there is none (arm64).
local function processor(info)
  local name = info:match("model name%s*:%s*([^\n]+)") or info:match("CPU part%s*:%s*([^\n]+)")
  local _, count = info:gsub("processor%s*:", "")
  return ("%s, %d processors"):format(name or "unknown processor", count)
end

-- Doubles of a vector, as core/engine/base/processor.c finds it, and as HOOKE_LANES asks.
local function lanes(info, asked)
  local flags = " " .. (info:match("flags%s*:%s*([^\n]+)") or "") .. " "
  local function has(...)
    for _, flag in ipairs { ... } do
      if not flags:find(" " .. flag .. " ", 1, true) then return false end
    end
    return true
  end
  local most = has("avx2", "fma") and (has("avx512f", "avx512vl", "avx512dq") and 8 or 4) or 2
  local taken = (asked == 2 or asked == 4) and asked < most and asked or most
  local name = { [2] = "two doubles", [4] = "four doubles (AVX2)", [8] = "eight doubles (AVX-512)" }
  return "vectors of " .. name[taken] .. (taken < most and (", HOOKE_LANES=%d of %d"):format(taken, most) or "")
end

local function caches(index)
  local found = {}
  for k = 0, 9 do
    local folder = index .. k .. "/"
    local level, kind, size = read(folder .. "level"), read(folder .. "type"), read(folder .. "size")
    if level ~= "" and kind ~= "Instruction" then found[#found + 1] = ("L%s %s"):format(level, size) end
  end
  return #found > 0 and "caches " .. table.concat(found, ", ") or "caches unknown"
end

-- The paragraphs that name build/bench/NAME, with the table after one.
local function said_of(name, text)
  local found, table_follows = {}, false
  for block in (text .. "\n\n"):gmatch("(.-)\n\n+") do
    local names = (block .. "\n"):find("build/bench/" .. name .. "%f[^%w_]")
    if names or (table_follows and block:sub(1, 1) == "|") then found[#found + 1] = block end
    table_follows = names ~= nil
  end
  return table.concat(found, "\n\n")
end

local function check()
  local info = "processor\t: 0\nmodel name\t: Some CPU\nflags\t\t: avx2 fma\nprocessor\t: 1\nmodel name\t: Some CPU\n"
  assert(processor(info) == "Some CPU, 2 processors")
  assert(lanes(info) == "vectors of four doubles (AVX2)" and lanes(info, 2) == "vectors of two doubles, HOOKE_LANES=2 of 4")
  assert(said_of("a", "x `build/bench/a`:\n\n| t |\n\nbuild/bench/ab\n\nz") == "x `build/bench/a`:\n\n| t |")
end

check()
if arg[1] then
  local text = said_of(arg[1], read("README.md"))
  if text ~= "" then print("README.md:\n" .. text:gsub("[^\n]+", "  | %0") .. "\nhere:") end
else
  local info = read("/proc/cpuinfo")
  print(processor(info))
  print(lanes(info, tonumber(os.getenv("HOOKE_LANES"))))
  print(caches("/sys/devices/system/cpu/cpu0/cache/index"))
  print("load " .. read("/proc/loadavg"):match("^%S*") .. " before the first; times are mostly of the wall, the least of pieces: a "
    .. "thread's own clock is up to a quarter wrong beside busy neighbours")
end

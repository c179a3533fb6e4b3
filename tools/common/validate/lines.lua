-- What `hooke validate` prints: a line for each quantity.
local lines = {}

-- Takes the result of one level into its problem.
function lines.take(question, result)
  local problem, cell = question.problem, question.cell
  local function fail(why)
    problem.failed = ("at%s%s: %s"):format(cell.n and (" n = %g"):format(cell.n) or "",
      cell.h and (" h = %.6g"):format(cell.h) or "", why)
  end
  if result.failed then return fail(result.failed) end
  cell.values = result.answer
  for k, value in ipairs(cell.values) do
    if value - value ~= 0 then fail(("'%s' is no finite number"):format(problem.description.quantities[k].name)) end
  end
  problem.cost.evaluations = problem.cost.evaluations + result.work.evaluations
  problem.cost.seconds = problem.cost.seconds + result.seconds
end

-- 1234567 -> 1,234,567
function lines.count(n)
  local text = ("%.0f"):format(n)
  return (text:reverse():gsub("(%d%d%d)", "%1,"):reverse():gsub("^,", ""))
end

local rounding = 1e-9 -- noise up to this is that of numbers, not of a method

function lines.order_text(c)
  if not c then return nil end
  if c.exact then return c.noise > rounding and "in noise" or "exact" end
  if c.at_least then return ("above %.1f"):format(c.at_least) end
  return c.order and ("%.2f"):format(c.order) or "none"
end

-- With the expected order in brackets.
function lines.order_cell(found, axis)
  local text, expected = lines.order_text(found[axis]), found.quantity.order[axis]
  if not text then return "" end
  return expected and not found[axis].exact and ("%s (%g)"):format(text, expected) or text
end

-- As many digits of the value as agree, and two more; at most `most`.
function lines.value_text(found, most)
  local digits = math.max(4, math.min(most or 16, math.floor(found.digits) + 2))
  return ("%%.%dg"):format(digits):format(found.value + 0.0 == 0 and 0 or found.value)
end

local function line_of(problem, found)
  local q, orders = found.quantity, {}
  for _, axis in ipairs { "space", "time" } do
    local text = lines.order_text(found[axis])
    if text then orders[#orders + 1] = axis .. " " .. text end
  end
  return ("%-5s %s: %s %s%s (reference %.12g: %s), %.1f digits, order in %s, %s evaluations, %.2g s"):format(
    #found.faults == 0 and "ok" or "WRONG", problem.name, q.name, lines.value_text(found), q.unit and " " .. q.unit or "",
    q.reference, q.source, found.digits, table.concat(orders, ", in "), lines.count(problem.cost.evaluations),
    problem.cost.seconds)
end

-- The values of all levels, for authors of problems.
local function print_levels(found)
  for _, axis in ipairs { "space", "time" } do
    local c = found[axis]
    for k, h in ipairs(c and c.h or {}) do
      print(("        %s  %-22.17g off by %.2g"):format(axis == "space" and ("n = %-10g"):format(1 / h) or
        ("h = %-10.4g"):format(h), c.v[k], math.abs(c.v[k] - found.quantity.reference) / found.quantity.scale))
    end
  end
end

-- Prints all; returns the number of quantities and problems that are wrong.
function lines.print(list, levels)
  local wrong, quantities, topic = 0, 0, nil
  for _, problem in ipairs(list) do
    if problem.topic ~= topic then
      topic = problem.topic
      print(topic)
    end
    if problem.failed then
      wrong = wrong + 1
      print(hooke.plain(("  FAILED %s: %s"):format(problem.name, problem.failed)))
    end
    for _, found in ipairs(problem.found) do
      quantities = quantities + 1
      print("  " .. line_of(problem, found))
      if levels then print_levels(found) end
      if #found.faults > 0 then
        wrong = wrong + 1
        print("        " .. table.concat(found.faults, "; "))
      end
    end
  end
  print(("%d problems, %d quantities: %s"):format(#list, quantities, wrong == 0 and "all within their tolerances"
    or wrong .. " wrong"))
  return wrong
end

function lines.list(list)
  for _, problem in ipairs(list) do
    print(hooke.plain(("%-14s %-24s %s"):format(problem.topic, problem.name, problem.title)))
  end
  return 0
end

return lines

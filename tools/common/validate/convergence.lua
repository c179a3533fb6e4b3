-- What a sequence of values at finer and finer levels says: the order at which it converges, measured without the
-- reference, and the value that it converges to.
--
-- With v(h) = v + C h^p at three sizes h1 > h2 > h3, (v1 - v2)/(v2 - v3) = (h1^p - h2^p)/(h2^p - h3^p) gives p, and then
-- v = v3 + (v3 - v2) h3^p/(h2^p - h3^p): Richardson's extrapolation with the measured order (Roache, Verification and
-- Validation in Computational Science and Engineering, 1998, sections 5.10 and 5.11, for the unequal ratios too).
local convergence = {}

local smallest_order, largest_order = 0.1, 16

-- The p at which the quotient of differences is `quotient`; it rises with p. nil: none in the range.
local function solve_order(h, quotient)
  local function at(p)
    return ((h[1] / h[2]) ^ p - 1) / (1 - (h[3] / h[2]) ^ p)
  end
  local low, high = smallest_order, largest_order
  if quotient < at(low) or quotient > at(high) then return nil end
  for _ = 1, 60 do
    local middle = (low + high) / 2
    if at(middle) < quotient then low = middle else high = middle end
  end
  return (low + high) / 2
end

-- h: sizes from coarse to fine; v: values at them; noise: differences up to it say nothing (rounding, an iteration's
-- tolerance, the width of a bisection). Returns
--   value   to which the sequence converges, as far as it tells
--   order   measured from the finest three levels whose differences are above the noise; nil: not measured
--   at_least  in its place, where the second step already is in the noise
--   exact   true: the levels do not differ by more than the noise
--   doubt   a text: why there is no order where there should be one
--   in_noise  true: the finest levels differ by the noise only, and are not extrapolated
--   spread  |difference of the finest two|
function convergence.of(h, v, noise)
  local n = #v
  local found = { value = v[n], spread = math.abs(v[n] - v[n - 1]) }
  local fine = n
  while fine > 1 and math.abs(v[fine] - v[fine - 1]) <= noise do fine = fine - 1 end
  if fine == 1 then
    found.exact, found.noise = true, noise
    return found
  end
  if fine < 3 then -- converged to the noise after one step
    found.at_least = solve_order(h, math.abs(v[1] - v[2]) / noise)
    return found
  end
  local a, b = v[fine - 2] - v[fine - 1], v[fine - 1] - v[fine]
  if a / b <= 0 then
    found.doubt = ("the values go back and forth: %.3g, then %.3g"):format(-a, -b)
    return found
  end
  local sizes = { h[fine - 2], h[fine - 1], h[fine] }
  local p = solve_order(sizes, a / b)
  if not p then
    found.doubt = ("the differences, %.3g and %.3g, fit no order from %g to %g"):format(-a, -b, smallest_order,
      largest_order)
    return found
  end
  found.order, found.in_noise = p, fine < n
  found.value = convergence.limit(h, v, found)
  return found
end

-- The order of several sequences that are the components of one vector, from the lengths of its differences: a component
-- alone may pass a place where its error changes sign. list: the v of each. As convergence.of, without a value.
function convergence.together(h, list, noise)
  local length = { [#h] = 0 } -- the way from each level to the last, whose differences are those lengths
  for k = #h - 1, 1, -1 do
    local square = 0
    for _, v in ipairs(list) do square = square + (v[k + 1] - v[k]) ^ 2 end
    length[k] = length[k + 1] + math.sqrt(square)
  end
  return convergence.of(h, length, noise)
end

-- The value to which v converges with the order of `common`.
function convergence.limit(h, v, common)
  local n, p = #h, common.order
  if not p or common.in_noise then return v[n] end
  return v[n] + (v[n] - v[n - 1]) * h[n] ^ p / (h[n - 1] ^ p - h[n] ^ p)
end

-- The value to which the finest three levels converge where their error has two known terms, v(h) = v + A h^p + B h^q.
function convergence.of_two_terms(h, v, p, q)
  local n = #h
  local a, b = h[n - 2] ^ p - h[n - 1] ^ p, h[n - 2] ^ q - h[n - 1] ^ q
  local c, d = h[n - 1] ^ p - h[n] ^ p, h[n - 1] ^ q - h[n] ^ q
  local r, s = v[n - 2] - v[n - 1], v[n - 1] - v[n]
  local det = a * d - b * c
  return v[n] - (r * d - b * s) / det * h[n] ^ p - (a * s - r * c) / det * h[n] ^ q
end

-- The number of decimal digits to which two numbers agree, relative to `scale`; 16, all that doubles have, at most.
function convergence.digits(value, reference, scale)
  local off = math.abs(value - reference) / scale
  if off ~= off then return 0 end
  return math.max(0, math.min(16, -math.log(off, 10)))
end

return convergence

--[[
what: a chain whose fastest mode is damped with a ratio of 10: its rate, not its frequency, limits the step
right: closed form, the modes of a chain with one end free
must: leapfrog, stoermer, blanes_moan, rk4, dopri5, implicit_midpoint, implicit_trapezoid, bdf2, tr_bdf2, esdirk4
]]
return require("_damped_chain")(10)

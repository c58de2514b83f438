function [f, k] = $name($arguments)
$about
% MATLAB R2016b or newer, or Octave; save as $name.m.
% f is the load, k the stiffness.
% The arguments may be arrays, which expand against each other.
zero = zeros(size($total));
$rows
f = zero;
k = zero;
apart = penetration < 0;
outside = ~is_inside($arguments);
$hidden
f(:) = load_inside($arguments);
k(:) = stiffness_inside($arguments);
% At first touch a formula may have no value, as log(0).
f((penetration == 0 & isnan(f(:).')) | apart) = 0;
k((penetration == 0 & isnan(k(:).')) | apart) = 0;
f(outside & ~apart) = NaN;
k(outside & ~apart) = NaN;
end

$numbers

$program

$helpers

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
outside = ~($domain);
$hidden
[load_of_law, stiffness_of_law, inside] = values_of_law($arguments);
f(:) = load_of_law;
k(:) = stiffness_of_law;
outside = outside | ~inside;
% At first touch a formula may have no value, as log(0).
f((penetration == 0 & isnan(f(:).')) | apart) = 0;
k((penetration == 0 & isnan(k(:).')) | apart) = 0;
f(outside & ~apart) = NaN;
k(outside & ~apart) = NaN;
end

function [load_of_law, stiffness_of_law, is_inside_law] = values_of_law($arguments)
$constants_of_load
$constants_of_stiffness
$numbers_at
load_of_law = $load;
stiffness_of_law = $stiffness;
is_inside_law = $inside;
end

$numbers

$program

$helpers

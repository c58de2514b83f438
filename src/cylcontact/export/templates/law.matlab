function [load, stiffness] = $name($arguments)
$comment
%
% MATLAB R2016b or newer, or Octave; save as $name.m.
% The arguments may be arrays, which expand against each other.
numbers = zeros(size($total));
$expanded
apart = penetration < 0;
outside = ~($domain);
$hidden
$constants
$at_pair
$if ends
outside = outside | ~($ends);
penetration(outside) = NaN;
$end
$at_depth
% At first touch the steps may have no value, as log(0).
load = f + numbers;
stiffness = k + numbers;
load((penetration == 0 & isnan(load)) | apart) = 0;
stiffness((penetration == 0 & isnan(stiffness)) | apart) = 0;
load(outside & ~apart) = NaN;
stiffness(outside & ~apart) = NaN;
end
$helpers

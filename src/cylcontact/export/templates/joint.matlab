function joint = $stem()
$comment
%
% MATLAB or Octave; this file is $stem.m.
%
%   joint = $stem();
%   impact_rate = joint.start();                         (the state: 0, not in contact)
%   wrench = joint.evaluate(impact_rate, bearing, pin);
%   impact_rate = joint.accept(impact_rate, bearing, pin);
joint.start = @start;
joint.evaluate = @evaluate;
joint.accept = @accept;
end

function impact_rate = start()
$start
end

function wrench = evaluate(impact_rate, bearing, pin)
$evaluate_constants
$evaluate
$results
end

function impact_rate = accept(impact_rate, bearing, pin)
$accept_constants
$accept
$next
end

$if program
$program

$end
function f = law_load(penetration)
% The law: N/mm at a penetration in mm.
$if table
persistent x y s
if isempty(x)
    x = [ ...
        $x];
    y = [ ...
        $y];
    s = [ ...
        $s];
end
$end
if penetration <= 0
    f = 0;
    return
end
$if table
at = log(penetration);
low = 1;
high = $last;
while high - low > 1
    middle = floor((low + high) / 2);
    if x(middle) <= at
        low = middle;
    else
        high = middle;
    end
end
x_0 = x(low);
y_0 = y(low);
s_0 = s(low);
x_1 = x(high);
y_1 = y(high);
s_1 = s(high);
$end
$law_constants
$law
end

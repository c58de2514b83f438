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
impact_rate = zeros(1, $contacts);
end

function wrench = evaluate(impact_rate, bearing, pin)
w = wrench_of(impact_rate, bearing, pin, work());
$results
end

function impact_rate = accept(impact_rate, bearing, pin)
impact_rate = next_rates(impact_rate, bearing, pin, work());
end

function w = work()
$work
end

$program
$helpers

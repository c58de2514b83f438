function joint = $stem()
$comment
%
% MATLAB or Octave.
joint.start = @() 0;
joint.evaluate = @evaluate;
joint.accept = @accept;
end

function wrench = evaluate(impact_rate, bearing, pin)
$evaluate_constants
$evaluate
wrench.force_bearing = [force_x, force_y];
wrench.moment_bearing = moment_b;
wrench.force_pin = [-force_x, -force_y];
wrench.moment_pin = moment_p;
wrench.penetration = delta;
wrench.penetration_rate = rate;
wrench.normal_force = normal;
wrench.friction_force = tangential;
wrench.tangential_velocity = v_t;
wrench.dissipated_power = power;
wrench.flag = flag;
end

function impact_rate = accept(impact_rate, bearing, pin)
$accept_constants
$accept
impact_rate = next_rate;
end

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

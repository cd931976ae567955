% Tasks 7 to 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M.
v = course_values();
[t, omega, Iq, T] = recording('JLoadAndFriction');
alpha = num_derivative(omega, T);
M = torqueconstant(Iq) .* Iq;
show('largest speed', max(abs(omega)), 'rad/s');
show('largest acceleration', max(abs(alpha)), 'rad/s^2');
show('largest torque', max(abs(M)), 'N*m');

width = 4;  % differences in a mean: it is 1.5 samples late, and the backward difference half a sample
delay = width / 2;
alpha_filt = conv(alpha(2:end), ones(width, 1) / width, 'valid');
sync = (1 : numel(alpha_filt))' + delay;
fast = abs(omega(sync)) >= 20;
show('samples remaining', sum(fast), '1');
show('samples removed', numel(t) - sum(fast), '1');

kept = sync(fast);
A = [alpha_filt(fast), omega(kept), sign(omega(kept))];
theta = A \ M(kept);
show('J', theta(1) * 1e4, 'kg*cm^2');
show('K_fric_w', theta(2), 'N*m*s/rad');
show('K_fric_0', theta(3), 'N*m');
show('E', sum((M(kept) - A * theta).^2), '(N*m)^2');
show('J_load', (theta(1) - v.rotor_inertia.value) * 1e4, 'kg*cm^2');
if usejava('desktop')
    M_est = [alpha_filt, omega(sync), sign(omega(sync))] * theta;
    plot(t, M, t(sync), M_est); xlabel('t_{sync} / s'); ylabel('torque / (N*m)'); legend('M', 'M_{est}'); grid on
end
